// SPDX-License-Identifier: Apache-2.0
/// A recorder whose disk gets full, and has room again.
#include <algorithm>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include "tests/components/recorder/recorder_fixture.hpp"
#include "tests/support/comes_true.hpp"
#include "tests/support/full_disk.hpp"

namespace strata::recorder {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class RecorderOnAFullDisk : public RecorderStorage {
 protected:
  /// Ticks until an error was told that says this; all that were told till then.
  static std::vector<std::string> tick_until_told(runtime::Host& host, const std::string& what) {
    std::vector<std::string> told;
    EXPECT_TRUE(test::comes_true([&] {
      host.tick();
      for (std::string& error : host.take_errors()) told.push_back(std::move(error));
      return std::any_of(told.begin(), told.end(), [&](const std::string& error) {
        return error.find(what) != std::string::npos;
      });
    })) << what;
    return told;
  }
};

TEST_P(RecorderOnAFullDisk, TellsItOnceAndGoesOnInAnotherFileWhenThereIsRoomAgain) {
  auto scans = writer("/scan", "default");
  const auto host = make(", topics: [/scan]");
  host->activate();
  Messages sent;
  const auto publish = [&](int number) {
    scans.publish(numbered(number));
    sent["/scan"].push_back(convert::to_cdr(numbered(number)));
  };
  for (int i = 0; i < 10; ++i) publish(i);
  {
    const test::FullDisk full;
    publish(10);
    EXPECT_THAT(tick_until_told(*host, bag().string()), ElementsAre(HasSubstr("free some space")));
    for (int i = 11; i < 20; ++i) publish(i);
    host->tick();
    host->tick();
    EXPECT_THAT(host->take_errors(), ::testing::IsEmpty());
  }
  EXPECT_THAT(tick_until_told(*host, "is written again"), ElementsAre(HasSubstr("0 messages")));
  for (int i = 20; i < 30; ++i) publish(i);
  host->stop();
  EXPECT_TRUE(host->take_errors().empty());
  EXPECT_EQ(read_bag(bag()), sent);
  const YAML::Node info =
      YAML::LoadFile((bag() / "metadata.yaml").string())["rosbag2_bagfile_information"];
  EXPECT_EQ(info["message_count"].as<int>(), 30);
  EXPECT_GE(info["files"].size(), 1U);
}

TEST_P(RecorderOnAFullDisk, SaysWhenItIsDeactivatedThatItsBagIsNotWhole) {
  auto scans = writer("/scan", "default");
  const auto host = make(", topics: [/scan]");
  host->activate();
  scans.publish(numbered(1));
  const test::FullDisk full;
  (void)tick_until_told(*host, bag().string());
  host->stop();
  EXPECT_THAT(host->take_errors(), ElementsAre(HasSubstr("free some space")));
}

INSTANTIATE_TEST_SUITE_P(All, RecorderOnAFullDisk,
                         testing::Values(Storage{"Sqlite3", "sqlite3", "SQLite schema 3"},
                                         Storage{"Mcap", "mcap", "MCAP"},
                                         Storage{"McapZstd", "mcap, compression: zstd",
                                                 "MCAP, chunks packed with zstd"}),
                         [](const auto& each) { return std::string(each.param.name); });

}  // namespace
}  // namespace strata::recorder
