// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <vector>

#include <gtest/gtest.h>

#include "components/convert/scan_messages.hpp"
#include "components/log/bag.hpp"
#include "components/log/log_reader.hpp"
#include "components/log/log_writer.hpp"
#include "components/player/register.hpp"
#include "core/base/error.hpp"
#include "tests/components/player/drive.hpp"
#include "tests/components/runtime/host_fixture.hpp"
#include "tests/components/runtime/status_watch.hpp"
#include "tests/support/test_data.hpp"

namespace strata::player {
namespace {

using sensor_msgs::msg::LaserScan;

TEST(Player, GivesReadersTheScansAndOdometryOfABag) {
  const test::TemporaryDirectory folder;
  const auto bag = folder.path() / "bag";
  test::write_drive(bag, 50);
  const auto recorded = log::read_observations(bag);
  ASSERT_EQ(recorded.size(), 50U);

  const auto participant = test::make_participant();
  test::Collector<LaserScan> scans(participant, "/scan", "lossless");
  test::Collector<nav_msgs::msg::Odometry> odometry(participant, "/odom", "lossless");
  test::Collector<rosgraph_msgs::msg::Clock> clock(participant, "/clock", "lossless");
  runtime::Registry registry;
  register_component(registry);
  const auto host = test::make_host("{type: strata::Player, name: player, parameters: {log: '" +
                                        bag.string() + "', rate: 1000000}}",
                                    registry, participant);
  host->activate();
  const auto got = scans.wait_for(50);
  ASSERT_EQ(got.size(), 50U);
  for (std::size_t i = 0; i < got.size(); ++i) {
    EXPECT_EQ(got[i], convert::to_message(recorded[i].scan, "laser")) << i;
  }
  EXPECT_EQ(odometry.wait_for(50).size(), 50U);
  EXPECT_EQ(clock.wait_for(50).size(), 50U);
  test::Collector<tf2_msgs::msg::TFMessage> late(test::make_participant(), "/tf_static",
                                                 "tf_static");
  const auto mounting = late.wait_for(1);
  ASSERT_EQ(mounting.size(), 1U);
  EXPECT_DOUBLE_EQ(mounting[0].transforms()[0].transform().translation().x(), 0.2);
  EXPECT_TRUE(host->take_errors().empty());
}

TEST(Player, TwoInOneProcessPlayTheirOwnLogsIntoTheirOwnNamespaces) {
  const test::TemporaryDirectory folder;
  test::write_drive(folder.path() / "a", 50);
  test::write_drive(folder.path() / "b", 30);
  const auto participant = test::make_participant();
  test::Collector<LaserScan> scans_a(participant, "/a/scan", "lossless");
  test::Collector<LaserScan> scans_b(participant, "/b/scan", "lossless");
  runtime::Registry registry;
  register_component(registry);
  const auto entry = [&](const std::string& scope) {
    return "{type: strata::Player, name: player, namespace: /" + scope + ", parameters: {log: '" +
           (folder.path() / scope).string() + "', rate: 1000000}}";
  };
  const auto host = test::make_host(entry("a") + ", " + entry("b"), registry, participant);
  host->activate();
  const auto a = scans_a.wait_for(50);
  const auto b = scans_b.wait_for(30);
  ASSERT_EQ(a.size(), 50U);
  ASSERT_EQ(b.size(), 30U);
  EXPECT_FLOAT_EQ(a.back().ranges()[2], 3.0F + 49.0F);
  EXPECT_FLOAT_EQ(b.back().ranges()[2], 3.0F + 29.0F);
  host->stop();
  EXPECT_EQ(scans_b.wait_for(30).size(), 30U);
  EXPECT_TRUE(host->take_errors().empty());
}

TEST(Player, StopsInTheMiddleOfALog) {
  const test::TemporaryDirectory folder;
  test::write_drive(folder.path() / "bag", 50);
  const auto participant = test::make_participant();
  test::Collector<LaserScan> scans(participant, "/scan", "lossless");
  runtime::Registry registry;
  register_component(registry);
  const auto host = test::make_host("{type: strata::Player, name: player, parameters: {log: '" +
                                        (folder.path() / "bag").string() + "', rate: 0.001}}",
                                    registry, participant);
  host->activate();
  EXPECT_EQ(scans.wait_for(1).size(), 1U);
  host->stop();  // would otherwise play for 14 hours
  EXPECT_EQ(scans.wait_for(1).size(), 1U);
}

TEST(Player, BeginsAgainWhenItLoops) {
  const test::TemporaryDirectory folder;
  test::write_drive(folder.path() / "bag", 3);
  const auto participant = test::make_participant();
  test::Collector<LaserScan> scans(participant, "/scan", "lossless");
  const auto host = test::play(folder.path() / "bag", ", loop: true, rate: 1000", participant);
  host->activate();
  const auto got = scans.wait_for(7);
  ASSERT_GE(got.size(), 7U);
  for (std::size_t i = 0; i < 7; ++i) {
    EXPECT_FLOAT_EQ(got[i].ranges()[2], 3.0F + static_cast<float>(i % 3)) << i;
  }
}

TEST(Player, RefusesToBeginBehindTheEndOfTheLog) {
  const test::TemporaryDirectory folder;
  test::write_drive(folder.path() / "bag", 20);
  const auto participant = test::make_participant();
  const auto play = [&](const char* parameters) {
    (void)test::play(folder.path() / "bag", parameters, participant);
  };
  EXPECT_THROW(play(", start_s: 19.5"), ConfigError);
  EXPECT_THROW(play(", start_s: 19.5, mode: messages"), ConfigError);
  EXPECT_NO_THROW(play(", start_s: 19"));
}

TEST(Player, RefusesRatesThatItCannotPlayAt) {
  const test::TemporaryDirectory folder;
  test::write_drive(folder.path() / "bag", 20);
  const auto participant = test::make_participant();
  for (const char* rate : {"1e-9", "1e9", ".inf", "-.inf", ".nan", "-1", "0", "1e400"}) {
    EXPECT_THROW(
        (void)test::play(folder.path() / "bag", std::string(", rate: ") + rate, participant),
        ConfigError)
        << rate;
  }
  for (const char* start : {"-1", "1e300", ".inf", ".nan"}) {
    EXPECT_THROW(
        (void)test::play(folder.path() / "bag", std::string(", start_s: ") + start, participant),
        ConfigError)
        << start;
  }
}

/// How many writers a reader of another participant has found, to be waited for.
class Matches {
 public:
  Matches(const std::shared_ptr<bus::Participant>& participant, const std::string& topic)
      : reader_(
            participant, topic, bus::MessageType<LaserScan>::name, bus::qos_profile("lossless"),
            [](const auto&) {},
            [this] {
              const std::lock_guard lock(mutex_);
              changed_.notify_all();
            }) {}
  bool wait_for(int writers) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(20),
                             [&] { return reader_.matched() == writers; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bus::RawReader reader_;  // last: its callbacks use the others
};

TEST(Player, TakesItsWritersAwayAtCleanupAndPlaysAgainWhenConfiguredAgain) {
  const test::TemporaryDirectory folder;
  test::write_drive(folder.path() / "bag", 5);
  for (const std::string mode : {"robot", "messages"}) {
    const auto other = test::make_participant();
    Matches matches(other, "/scan");
    test::Collector<LaserScan> scans(other, "/scan", "lossless");
    const auto participant = test::make_participant();
    const auto host =
        test::play(folder.path() / "bag", ", loop: true, rate: 1000, mode: " + mode, participant);
    runtime::Component& player = *host->components()[0];
    for (int life = 0; life < 2; ++life) {
      ASSERT_TRUE(matches.wait_for(1)) << mode;
      const std::size_t before = scans.wait_for(0).size();
      player.activate();
      EXPECT_GE(scans.wait_for(before + 5).size(), before + 5) << mode;
      player.deactivate();
      player.cleanup();
      EXPECT_TRUE(matches.wait_for(0)) << mode;
      EXPECT_EQ(participant->published_topics().count("/scan"), 0U) << mode;
      player.configure();
    }
    host->stop();
    EXPECT_TRUE(host->take_errors().empty());
  }
}

TEST(Player, LeavesOutMessagesWithoutAHeaderAndCountsThem) {
  const test::TemporaryDirectory folder;
  const std::vector<std::uint8_t> message = {0, 1, 0, 0, 42, 0, 0, 0};
  {
    log::BagWriter bag(folder.path() / "bag", log::BagStorage::kMcap);
    const std::size_t topic = bag.add_topic({"/strange", "strange_msgs/msg/Thing", "cdr", ""});
    for (int i = 0; i < 6; ++i) {
      const auto bytes = static_cast<std::ptrdiff_t>(i % 2 == 0 ? i : 8);
      bag.write(topic, Stamp{1'000'000'000LL + i * 1'000'000LL},
                std::vector<std::uint8_t>(message.begin(), message.begin() + bytes));
    }
  }
  const auto participant = test::make_participant();
  std::mutex mutex;
  std::condition_variable changed;
  int got = 0;
  const bus::RawReader reader(participant, bus::TopicName("/strange"), "strange_msgs/msg/Thing",
                              bus::qos_profile("default"), [&](const bus::RawMessage& came) {
                                const std::lock_guard lock(mutex);
                                EXPECT_GE(came.cdr.size(), 4U);
                                ++got;
                                changed.notify_all();
                              });
  test::StatusWatch watch(participant);
  const auto host = test::play(folder.path() / "bag", ", mode: messages", participant);
  host->activate();
  {
    std::unique_lock lock(mutex);
    // Behind those of 0 and 2 bytes come 8, 8, 4 and 8.
    EXPECT_TRUE(changed.wait_for(lock, std::chrono::seconds(20), [&] { return got == 4; })) << got;
  }
  const auto status = watch.wait_for(
      *host, [](const auto& s) { return test::value_of(s, "messages left out") == "2"; });
  EXPECT_EQ(test::value_of(status, "messages left out"), "2");
  EXPECT_TRUE(host->take_errors().empty());
}

TEST(Player, PlaysMessagesOfAnyTypeAsTheyWereRecorded) {
  const test::TemporaryDirectory folder;
  const std::vector<std::uint8_t> unknown = {0, 1, 0, 0, 42, 0, 0, 0};
  log::BagWriter bag(folder.path() / "bag", log::BagStorage::kMcap);
  const std::size_t topic =
      bag.add_topic({"/strange", "strange_msgs/msg/Thing", "cdr",
                     "- history: 1\n  depth: 3\n  reliability: 1\n  durability: 1\n"});
  const std::size_t other = bag.add_topic({"/other", "strange_msgs/msg/Thing", "cdr", ""});
  for (int i = 0; i < 3; ++i) {
    bag.write(topic, Stamp{1'000'000'000LL * (i + 1)}, unknown);
    bag.write(other, Stamp{1'000'000'000LL * (i + 1)}, unknown);
  }
  bag.close();
  const auto participant = test::make_participant();
  std::mutex mutex;
  std::condition_variable changed;
  std::vector<std::vector<std::uint8_t>> got;
  const bus::RawReader reader(participant, "/strange", "strange_msgs/msg/Thing",
                              bus::qos_profile("lossless"), [&](const bus::RawMessage& message) {
                                const std::lock_guard lock(mutex);
                                got.push_back(message.cdr);
                                changed.notify_all();
                              });
  const auto host = test::play(folder.path() / "bag",
                               ", mode: messages, topics: [/strange], rate: 1000000", participant);
  host->activate();
  std::unique_lock lock(mutex);
  changed.wait_for(lock, std::chrono::seconds(20), [&] { return got.size() >= 3; });
  EXPECT_EQ(got, std::vector(3, unknown));
  EXPECT_EQ(participant->published_topics().count("/other"), 0U);
  EXPECT_TRUE(participant->published_topics().at("/strange").transient_local);
}

}  // namespace
}  // namespace strata::player
