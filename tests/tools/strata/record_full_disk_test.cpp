// SPDX-License-Identifier: Apache-2.0
/// A disk that is full while `strata record` works, or when it ends: the exit status says whether
/// the bag has all that came.
#include <bit>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include "components/bus/endpoint.hpp"
#include "tests/components/bus/domain.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/comes_true.hpp"
#include "tests/support/test_data.hpp"

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr auto kDiskPatience = std::chrono::seconds(60);
/// Longer than the recorder keeps anything in memory.
constexpr auto kRetryPeriod = std::chrono::seconds(3);
constexpr int kRanges = 4'000;
constexpr std::uintmax_t kScanBytes = kRanges * sizeof(float);
/// Scans; a megabyte waits.
constexpr int kMoreThanWaits = 200;

std::uintmax_t bytes_in(const fs::path& folder) {
  std::uintmax_t sum = 0;
  for (const auto& entry : fs::directory_iterator(folder)) sum += entry.file_size();
  return sum;
}

/// A scan that does not become small when it is packed.
sensor_msgs::msg::LaserScan large_scan() {
  sensor_msgs::msg::LaserScan scan;
  std::uint32_t number = 1;
  for (int i = 0; i < kRanges; ++i) {
    number = number * 1'664'525U + 1'013'904'223U;
    scan.ranges().push_back(std::bit_cast<float>(number));
  }
  return scan;
}

class RecordOnAFullDisk : public testing::TestWithParam<const char*> {
 protected:
  /// Writing fails in the recorder, as on a disk without space, instead of ending it.
  static void SetUpTestSuite() { (void)std::signal(SIGXFSZ, SIG_IGN); }
  static void limit_disk(const test::ChildProcess& process, rlim_t bytes) {
    rlimit limit{};
    ASSERT_EQ(prlimit(process.pid(), RLIMIT_FSIZE, nullptr, &limit), 0);
    limit.rlim_cur = bytes;
    ASSERT_EQ(prlimit(process.pid(), RLIMIT_FSIZE, &limit, nullptr), 0);
  }
  static void fill_disk(const test::ChildProcess& process) { limit_disk(process, 0); }
  static void free_disk(const test::ChildProcess& process) { limit_disk(process, RLIM_INFINITY); }

  /// Records into `bag()` and has written a scan.
  void start() {
    ASSERT_NE(recorder_.wait_for_line("recording into", kDiskPatience), "");
    ASSERT_TRUE(scans_.raw().wait_for_readers(1, kDiskPatience));
    const std::uintmax_t before = bytes_in(bag());
    // It reads by best effort, since nobody published the topic when it began: what is sent before
    // it knows of the writer is lost. Once a scan is there nothing waits to be written but what
    // ends a bag.
    auto published = std::chrono::steady_clock::time_point::min();
    ASSERT_TRUE(test::comes_true([&] {
      const auto now = std::chrono::steady_clock::now();
      if (published + kRetryPeriod < now) {
        scans_.publish(large_scan());
        published = now;
      }
      return bytes_in(bag()) > before + kScanBytes;
    }));
  }
  [[nodiscard]] fs::path bag() const { return folder_.path() / "bag"; }

 private:
  const test::TemporaryDirectory folder_;

 protected:
  test::ChildProcess recorder_{
      {STRATA_PROGRAM, "record", "--out", bag().string(), "--storage", GetParam(), "--topics",
       "/scan:sensor_msgs/msg/LaserScan", "--transport", "loopback", "--domain",
       std::to_string(test::own_domain())},
      {},
      test::ChildProcess::Errors::kMerged};
  bus::Writer<sensor_msgs::msg::LaserScan> scans_{test::make_participant(), "/scan",
                                                  bus::qos_profile("lossless")};
};

TEST_P(RecordOnAFullDisk, FailsAlsoWhenOnlyItsEndCannotBeWritten) {
  start();
  fill_disk(recorder_);
  recorder_.send(SIGINT);
  EXPECT_EQ(recorder_.wait(), 1);
  EXPECT_THAT(recorder_.rest(), AllOf(HasSubstr("strata record: error: " + bag().string()),
                                      HasSubstr("; then record again")));
}

TEST_P(RecordOnAFullDisk, EndsWellWhenThereIsRoomAgainAndNothingWasLost) {
  start();
  fill_disk(recorder_);
  scans_.publish(large_scan());
  ASSERT_NE(recorder_.wait_for_line("warning: ", kDiskPatience), "");
  free_disk(recorder_);
  ASSERT_THAT(recorder_.wait_for_line("warning: ", kDiskPatience),
              HasSubstr("is written again, in another file of the bag; 0 messages"));
  recorder_.send(SIGINT);
  EXPECT_EQ(recorder_.wait(), 0) << recorder_.rest();
}

TEST_P(RecordOnAFullDisk, FailsWhenMessagesWereLostMeanwhile) {
  start();
  fill_disk(recorder_);
  for (int i = 0; i < kMoreThanWaits; ++i) scans_.publish(large_scan());
  ASSERT_NE(recorder_.wait_for_line("warning: ", kDiskPatience), "");
  // More than it keeps for when there is room again.
  for (int i = 0; i < kMoreThanWaits; ++i) {
    scans_.publish(large_scan());
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  free_disk(recorder_);
  ASSERT_THAT(recorder_.wait_for_line("warning: ", kDiskPatience),
              AllOf(HasSubstr("is written again"), testing::Not(HasSubstr("; 0 messages"))));
  recorder_.send(SIGINT);
  EXPECT_EQ(recorder_.wait(), 1);
  EXPECT_THAT(recorder_.rest(), HasSubstr("strata record: error: " + bag().string()));
}

INSTANTIATE_TEST_SUITE_P(All, RecordOnAFullDisk, testing::Values("mcap", "sqlite3"));

}  // namespace
}  // namespace strata::tools
