// SPDX-License-Identifier: Apache-2.0
/// How a recording ends when the terminal that it was begun in is gone.
#include <chrono>
#include <csignal>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "components/bus/endpoint.hpp"
#include "components/log/bag.hpp"
#include "tests/components/bus/domain.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/test_data.hpp"

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

constexpr auto kEndPatience = std::chrono::seconds(30);

class RecordEnd : public testing::Test {
 protected:
  /// before, after: of a shell's command line, which the recorder takes the place of.
  void start(const std::string& before, const std::string& after) {
    recorder_ = std::make_unique<test::ChildProcess>(
        std::vector<std::string>{"bash", "-c",
                                 before + " '" STRATA_PROGRAM "' record --out '" + bag().string() +
                                     "' --transport loopback --domain " +
                                     std::to_string(test::own_domain()) + " " + after},
        std::vector<std::string>{}, test::ChildProcess::Errors::kMerged);
  }
  /// Once it reads the topic, which it finds while it lives.
  void publish() {
    bus::Writer<sensor_msgs::msg::LaserScan> scans(test::make_participant(), "/scan",
                                                   bus::qos_profile("lossless"));
    ASSERT_TRUE(scans.raw().wait_for_readers(1, kEndPatience));
    scans.publish({});
    // A reliable writer is gone when its readers have what it wrote.
  }
  [[nodiscard]] fs::path bag() const { return folder_.path() / "bag"; }

  const test::TemporaryDirectory folder_;
  std::unique_ptr<test::ChildProcess> recorder_;
};

TEST_F(RecordEnd, IsWholeWhereTheTerminalIsGone) {
  start("exec", "");
  ASSERT_NE(recorder_->wait_for_line("recording into", kEndPatience), "");
  recorder_->send(SIGHUP);
  EXPECT_EQ(recorder_->wait(), 0) << recorder_->rest();
  EXPECT_TRUE(fs::exists(bag() / "metadata.yaml"));
}

TEST_F(RecordEnd, DoesNotComeWithTheTerminalsWhereThatIsIgnored) {
  start("trap '' HUP; exec", "");
  ASSERT_NE(recorder_->wait_for_line("recording into", kEndPatience), "");
  recorder_->send(SIGHUP);
  publish();
  recorder_->send(SIGTERM);
  EXPECT_EQ(recorder_->wait(), 0) << recorder_->rest();
}

TEST_F(RecordEnd, IsWholeWhereNobodyReadsWhatItSays) {
  start("exec", "2> >(exec true)");
  publish();
  recorder_->send(SIGINT);
  EXPECT_EQ(recorder_->wait(), 0);
  EXPECT_TRUE(fs::exists(bag() / "metadata.yaml"));
}

}  // namespace
}  // namespace strata::tools
