// SPDX-License-Identifier: Apache-2.0
/// What a recorder does with messages that come while it is paused.
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/log/sqlite_handles.hpp"
#include "components/runtime/parameters.hpp"
#include "tests/components/recorder/recorder_fixture.hpp"

namespace strata::recorder {
namespace {

TEST_P(RecorderStorage, LeavesOutWhatComesWhileItIsPaused) {
  auto scans = writer("/scan", "default");
  const auto host = make("");
  host->activate();
  EXPECT_FALSE(call<bus::srv::IsPaused>("is_paused").paused());
  scans.publish(numbered(1));
  call<bus::srv::Pause>("pause");
  EXPECT_TRUE(call<bus::srv::IsPaused>("is_paused").paused());
  scans.publish(numbered(2));
  call<bus::srv::Resume>("resume");
  scans.publish(numbered(3));
  rcl_interfaces::srv::SetParameters_Request pause;
  pause.parameters({runtime::parameter("paused", runtime::parameter_value(true))});
  EXPECT_TRUE(call<bus::srv::SetParameters>("set_parameters", pause).results().at(0).successful());
  EXPECT_TRUE(call<bus::srv::IsPaused>("is_paused").paused());
  scans.publish(numbered(4));
  host->stop();
  EXPECT_TRUE(host->take_errors().empty());
  EXPECT_EQ(read_bag(bag()).at("/scan"),
            (std::vector{convert::to_cdr(numbered(1)), convert::to_cdr(numbered(3))}));
}

TEST_P(RecorderStorage, RecordsWhatWasLatchedWhileItWasPausedOnceItGoesOn) {
  auto map = writer("/map", "latched");
  auto other_map = writer("/map", "latched");
  auto scans = writer("/scan", "default");
  const auto host = make(", paused: true, topics: [/map, /scan]");
  host->activate();
  map.publish(numbered(1));
  call<bus::srv::Resume>("resume");
  scans.publish(numbered(2));
  call<bus::srv::Pause>("pause");
  scans.publish(numbered(3));
  const std::int64_t before_ns = now_ns();
  map.publish(numbered(4));
  other_map.publish(numbered(5));
  map.publish(numbered(6));
  const std::int64_t after_ns = now_ns();
  EXPECT_TRUE(call<bus::srv::IsPaused>("is_paused").paused());
  const std::int64_t kept_ns = now_ns();
  while (now_ns() - kept_ns <= after_ns - before_ns) std::this_thread::yield();
  for (const int again : {0, 1}) {  // nothing is left that would be recorded twice
    call<bus::srv::Resume>("resume");
    if (again == 0) call<bus::srv::Pause>("pause");
  }
  scans.publish(numbered(7));
  call<bus::srv::Pause>("pause");
  map.publish(numbered(8));
  host->stop();  // still paused
  EXPECT_TRUE(host->take_errors().empty());
  const auto reader = log::BagReader::open(bag());
  std::vector<std::vector<std::uint8_t>> recorded;
  std::vector<std::int64_t> stamps;
  for (log::BagMessage message; reader->next(message);) {
    recorded.push_back(message.data);
    stamps.push_back(message.stamp.ns);
  }
  std::vector<std::vector<std::uint8_t>> expected;
  for (const int number : {1, 2, 5, 6, 7}) expected.push_back(convert::to_cdr(numbered(number)));
  ASSERT_TRUE(recorded == expected);
  EXPECT_LT(stamps[1], before_ns);
  EXPECT_GT(stamps[2], after_ns) << "where the recording goes on, not where it was published";
}

TEST_P(RecorderStorage, KeepsAsManyLatchedMessagesOfAWriterAsItIsToldTo) {
  bus::QosProfile qos = bus::qos_profile("latched");
  qos.depth = 5;
  bus::Writer<sensor_msgs::msg::LaserScan> things(participant_, "/things", qos);
  for (const int depth : {0, 1, 3}) {
    const auto host = make(
        ", number_if_exists: true, paused: true, topics: [/things], "
        "latched_depth: " +
        std::to_string(depth));
    host->activate();
    for (int i = 0; i < 6; ++i) things.publish(numbered(i));
    call<bus::srv::Resume>("resume");
    host->stop();
    const auto folder = depth == 0 ? bag().string() : bag().string() + (depth == 1 ? "_2" : "_3");
    std::vector<std::vector<std::uint8_t>> last;
    for (int i = 6 - depth; i < 6; ++i) last.push_back(convert::to_cdr(numbered(i)));
    EXPECT_EQ(read_bag(folder)["/things"], last) << depth;
  }
}

/// Where one message can be refused and the next one not, by the bag's first file only.
class RecorderIntoSqlite : public RecorderStorage {
 protected:
  /// The bag takes nothing of that topic any more.
  void refuse(const std::string& topic) {
    sqlite3* opened = nullptr;
    ASSERT_EQ(sqlite3_open((bag() / "bag_0.db3").c_str(), &opened), SQLITE_OK);
    const log::Database database(opened);
    const std::string sql =
        "CREATE TRIGGER refuse BEFORE INSERT ON messages WHEN NEW.topic_id = "
        "(SELECT id FROM topics WHERE name = '" +
        topic + "') BEGIN SELECT RAISE(ABORT, 'not that one'); END";
    ASSERT_EQ(sqlite3_exec(opened, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
        << sqlite3_errmsg(opened);
  }
};

TEST_P(RecorderIntoSqlite, TellsThatAFileRefusesAMessageAndKeepsItInTheNext) {
  auto bad = writer("/bad", "latched");
  auto good = writer("/good", "latched");
  const auto host = make(", paused: true, topics: [/bad, /good]");
  host->activate();
  host->tick();                                 // the topics are in the file
  (void)call<bus::srv::IsPaused>("is_paused");  // after the tick
  refuse("/bad");
  bad.publish(numbered(1));
  good.publish(numbered(2));
  rcl_interfaces::srv::SetParameters_Request resume;
  resume.parameters({runtime::parameter("paused", runtime::parameter_value(false))});
  EXPECT_TRUE(call<bus::srv::SetParameters>("set_parameters", resume).results().at(0).successful());
  EXPECT_FALSE(call<bus::srv::IsPaused>("is_paused").paused());
  EXPECT_THAT(host->take_errors(), testing::ElementsAre(testing::HasSubstr("bag_0.db3")));
  host->stop();
  EXPECT_THAT(
      host->take_errors(),
      testing::ElementsAre(testing::HasSubstr("in another file of the bag; 0 messages were lost")));
  EXPECT_EQ(read_bag(bag()), (Messages{{"/bad", {convert::to_cdr(numbered(1))}},
                                       {"/good", {convert::to_cdr(numbered(2))}}}));
}

TEST_P(RecorderStorage, LeavesItsBagCompleteWhenItIsResumedWhileItRests) {
  auto map = writer("/map", "latched");
  const auto host = make(", paused: true, topics: [/map]");
  runtime::Component& recorder = *host->components()[0];
  host->activate();
  map.publish(numbered(1));
  (void)call<bus::srv::IsPaused>("is_paused");  // after the message
  for (const bool goes_on : {false, true}) {
    recorder.deactivate();
    call<bus::srv::Resume>("resume");
    EXPECT_TRUE(std::filesystem::exists(bag() / "metadata.yaml"));
    EXPECT_TRUE(read_bag(bag()).empty());
    if (!goes_on) call<bus::srv::Pause>("pause");
    recorder.activate();
  }
  host->stop();
  EXPECT_TRUE(host->take_errors().empty());
  EXPECT_EQ(read_bag(bag()), (Messages{{"/map", {convert::to_cdr(numbered(1))}}}));
}

TEST_P(RecorderStorage, KeepsWhatIsLatchedOnATopicThatNobodyPublishedYet) {
  const auto host = make(", paused: true, topics: ['/map:sensor_msgs/msg/LaserScan']");
  host->activate();
  auto map = writer("/map", "latched");
  map.publish(numbered(1));
  call<bus::srv::Resume>("resume");
  host->stop();
  EXPECT_TRUE(host->take_errors().empty());
  EXPECT_EQ(read_bag(bag()), (Messages{{"/map", {convert::to_cdr(numbered(1))}}}));
}

TEST_P(RecorderStorage, KeepsWhatIsLatchedOnceNobodyPublishesTheTopicOtherwise) {
  auto volatile_map = std::make_unique<bus::Writer<sensor_msgs::msg::LaserScan>>(
      participant_, "/map", bus::qos_profile("default"));
  const auto host = make(", paused: true, topics: [/map]");
  host->activate();
  auto map = writer("/map", "latched");
  map.publish(numbered(1));
  (void)call<bus::srv::IsPaused>("is_paused");  // after the message
  volatile_map.reset();
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (!participant_->published_topics()["/map"].transient_local) {
    ASSERT_LT(std::chrono::steady_clock::now(), deadline);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  host->tick();  // finds it
  (void)call<bus::srv::IsPaused>("is_paused");
  map.publish(numbered(2));
  call<bus::srv::Resume>("resume");
  host->stop();
  EXPECT_TRUE(host->take_errors().empty());
  EXPECT_EQ(read_bag(bag()), (Messages{{"/map", {convert::to_cdr(numbered(2))}}}));
}

TEST_P(RecorderIntoSqlite, RecordsOfTheMapsThatCameWhileItRestedTheLast) {
  auto map = writer("/map", "latched");
  auto other_map = writer("/map", "latched");
  const auto host = make(", topics: [/map]");
  runtime::Component& recorder = *host->components()[0];
  host->activate();
  map.publish(numbered(1));
  (void)call<bus::srv::IsPaused>("is_paused");  // after the message
  recorder.deactivate();
  for (const int number : {2, 3, 4}) {
    map.publish(numbered(number));
    if (number == 2) other_map.publish(numbered(5));
    std::this_thread::sleep_for(runtime::Reception::kBurst + std::chrono::milliseconds(200));
  }
  recorder.activate();
  host->stop();
  EXPECT_TRUE(host->take_errors().empty());
  EXPECT_EQ(read_bag(bag()), (Messages{{"/map",
                                        {convert::to_cdr(numbered(1)), convert::to_cdr(numbered(5)),
                                         convert::to_cdr(numbered(4))}}}));
}

INSTANTIATE_TEST_SUITE_P(All, RecorderIntoSqlite,
                         testing::Values(Storage{"Sqlite3", "sqlite3", "SQLite schema 3"}),
                         [](const auto& each) { return std::string(each.param.name); });

}  // namespace
}  // namespace strata::recorder
