// SPDX-License-Identifier: Apache-2.0
/// What a bag lacks though its disk has room, and whether that is told.
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/components/recorder/recorder_fixture.hpp"
#include "tests/support/comes_true.hpp"

namespace strata::recorder {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class RecorderGaps : public RecorderStorage {
 protected:
  static const Recorder& recorder_of(const runtime::Host& host) {
    return dynamic_cast<const Recorder&>(*host.components().front());
  }
  /// Once everything that has come has been worked on.
  void settle(runtime::Host& host) {
    host.tick();
    (void)call<bus::srv::IsPaused>("is_paused");
  }
};

TEST_P(RecorderGaps, AreToldWithTheirNumberWhereMessagesCameTooFast) {
  auto map = writer("/map", "latched");
  auto other_map = writer("/map", "latched");
  const auto host = make(", topics: [/map], latched_depth: 1000");
  host->activate();
  for (auto* each : {&map, &other_map}) each->publish(numbered(0));
  settle(*host);
  EXPECT_TRUE(recorder_of(*host).is_whole());
  // While it rests nothing is taken out of the queue, which holds 1,000.
  host->components().front()->deactivate();
  for (auto* each : {&map, &other_map}) {
    for (int i = 1; i <= 750; ++i) each->publish(numbered(i));
  }
  host->components().front()->activate();
  settle(*host);
  EXPECT_FALSE(recorder_of(*host).is_whole());
  EXPECT_THAT(host->take_errors(),
              ElementsAre(AllOf(HasSubstr("lacks 500 messages"), HasSubstr("(/map: 500)"))));
  host->components().front()->deactivate();
  EXPECT_FALSE(recorder_of(*host).is_whole());
  host->stop();
  EXPECT_EQ(read_bag(bag())["/map"].size(), 1002U);
}

TEST_P(RecorderGaps, AreTopicsThatNobodyPublishedOrOfWhichNothingCame) {
  auto scans = writer("/scan", "default");
  auto odometry = writer("/odom", "default");
  const auto host =
      make(", topics: [/scan, /odom, /scan_raw, '/tip:sensor_msgs/msg/LaserScan', /late]");
  host->activate();
  scans.publish(numbered(1));
  auto late = writer("/late", "default");
  settle(*host);
  late.publish(numbered(2));
  ASSERT_TRUE(test::comes_true([&] {
    host->tick();
    const auto told = host->take_errors();
    EXPECT_LE(told.size(), 1U);
    return told == std::vector<std::string>{"/recorder: nobody publishes /scan_raw, /tip"};
  }));
  host->components().front()->deactivate();
  EXPECT_EQ(recorder_of(*host).unpublished(), "/scan_raw, /tip");
  EXPECT_EQ(recorder_of(*host).silent(), "/odom");
  EXPECT_TRUE(recorder_of(*host).is_whole());
  host->stop();
  EXPECT_THAT(host->take_errors(), IsEmpty());
}

TEST_P(RecorderGaps, AreNoneOfWritersThatComeLaterAndOfferLess) {
  auto reliable = writer("/scan", "default");
  auto latched = writer("/map", "latched");
  const auto host = make(", topics: [/scan, /map]");
  host->activate();
  auto best_effort = writer("/scan", "sensor_data");
  auto no_more_latched = writer("/map", "default");
  EXPECT_TRUE(test::comes_true([&] {
    host->tick();
    return best_effort.raw().matched() == 1 && no_more_latched.raw().matched() == 1;
  }));
  Messages sent;
  for (int i = 0; i < 5; ++i) {
    int number = 10 * i;
    for (auto* each : {&reliable, &best_effort}) {
      each->publish(numbered(++number));
      sent["/scan"].push_back(convert::to_cdr(numbered(number)));
      settle(*host);
    }
    for (auto* each : {&latched, &no_more_latched}) {
      each->publish(numbered(++number));
      sent["/map"].push_back(convert::to_cdr(numbered(number)));
      settle(*host);
    }
  }
  host->stop();
  EXPECT_THAT(host->take_errors(), IsEmpty());
  EXPECT_EQ(read_bag(bag()), sent) << "each once";
}

INSTANTIATE_TEST_SUITE_P(All, RecorderGaps,
                         testing::Values(Storage{"Sqlite3", "sqlite3", "SQLite schema 3"}),
                         [](const auto& each) { return std::string(each.param.name); });

}  // namespace
}  // namespace strata::recorder
