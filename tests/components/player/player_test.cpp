// SPDX-License-Identifier: Apache-2.0
#include "components/player/player.hpp"

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <vector>

#include <gtest/gtest.h>

#include "components/convert/scan_messages.hpp"
#include "components/log/bag.hpp"
#include "components/log/log_reader.hpp"
#include "components/player/register.hpp"
#include "core/base/error.hpp"
#include "tests/components/runtime/host_fixture.hpp"
#include "tests/support/test_data.hpp"

namespace strata::player {
namespace {

using sensor_msgs::msg::LaserScan;

/// A bag with scans, odometry and the laser's mounting.
void write_bag(const std::filesystem::path& folder, int scans) {
  log::BagWriter bag(folder, log::BagStorage::kSqlite3);
  const std::size_t odometry = bag.add_topic({"/odom", "nav_msgs/msg/Odometry", "cdr", ""});
  const std::size_t scan = bag.add_topic({"/scan", "sensor_msgs/msg/LaserScan", "cdr", ""});
  const std::size_t tf = bag.add_topic({"/tf_static", "tf2_msgs/msg/TFMessage", "cdr", ""});
  std::vector<Observation> observations;
  for (int i = 0; i < scans; ++i) {
    Observation observation;
    observation.scan.stamp = Stamp{1'000'000'000LL * (i + 1)};
    observation.scan.robot_from_laser = {0.2, 0.1, 0.0};
    observation.scan.range_max_m = 10.0F;
    observation.scan.angle_increment_rad = 0.1F;
    observation.scan.ranges_m = {1.0F, 2.0F, 3.0F + static_cast<float>(i)};
    observation.odom_from_robot = {0.1 * i, 0.0, 0.0};
    observation.has_odometry = true;
    observations.push_back(observation);
  }
  const auto into = [&](std::size_t topic, const Stamp& stamp) {
    return [&bag, topic, &stamp](const auto& message) {
      bag.write(topic, stamp, convert::to_cdr(message));
    };
  };
  Stamp now;
  LogPlayer player(observations, {[](const auto&) {},
                                  into(tf, now),
                                  [](const auto&) {},
                                  into(odometry, now),
                                  into(scan, now),
                                  {}});
  for (std::size_t i = 0; i < observations.size(); ++i) {
    now = observations[i].scan.stamp;
    player.publish(i);
  }
  bag.close();
}

TEST(Player, GivesReadersTheScansAndOdometryOfABag) {
  const test::TemporaryDirectory folder;
  const auto bag = folder.path() / "bag";
  write_bag(bag, 50);
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
  write_bag(folder.path() / "a", 50);
  write_bag(folder.path() / "b", 30);
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
  write_bag(folder.path() / "bag", 50);
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

/// A player that a test can talk to.
struct Playing {
  std::unique_ptr<runtime::Host> host;
  [[nodiscard]] Player& player() const { return dynamic_cast<Player&>(*host->components()[0]); }
};

Playing play(const std::filesystem::path& log, const std::string& parameters,
             const std::shared_ptr<bus::Participant>& participant) {
  runtime::Registry registry;
  register_component(registry);
  return {test::make_host("{type: strata::Player, name: player, parameters: {log: '" +
                              log.string() + "'" + parameters + "}}",
                          registry, participant)};
}

TEST(Player, WaitsWhilePausedAndGoesOnWhenResumed) {
  const test::TemporaryDirectory folder;
  write_bag(folder.path() / "bag", 20);
  const auto participant = test::make_participant();
  test::Collector<LaserScan> scans(participant, "/scan", "lossless");
  const Playing playing = play(folder.path() / "bag", ", paused: true, rate: 1000000", participant);
  playing.host->activate();
  EXPECT_TRUE(playing.player().is_paused());
  EXPECT_EQ(scans.wait_for(0).size(), 0U);
  playing.player().resume();
  EXPECT_EQ(scans.wait_for(20).size(), 20U);
}

TEST(Player, SeeksForwardsAndBackwards) {
  const test::TemporaryDirectory folder;
  write_bag(folder.path() / "bag", 20);
  const auto participant = test::make_participant();
  test::Collector<LaserScan> scans(participant, "/scan", "lossless");
  const Playing playing = play(folder.path() / "bag", ", start_s: 18, rate: 1000000", participant);
  playing.host->activate();
  const auto end = scans.wait_for(2);
  ASSERT_EQ(end.size(), 2U);
  EXPECT_FLOAT_EQ(end[0].ranges()[2], 3.0F + 18.0F);
  playing.player().seek(Duration::from_seconds(16.5));
  const auto again = scans.wait_for(5);
  ASSERT_EQ(again.size(), 5U);
  EXPECT_FLOAT_EQ(again[2].ranges()[2], 3.0F + 17.0F);
}

TEST(Player, BeginsAgainWhenItLoops) {
  const test::TemporaryDirectory folder;
  write_bag(folder.path() / "bag", 3);
  const auto participant = test::make_participant();
  test::Collector<LaserScan> scans(participant, "/scan", "lossless");
  const Playing playing = play(folder.path() / "bag", ", loop: true, rate: 1000", participant);
  playing.host->activate();
  const auto got = scans.wait_for(7);
  ASSERT_GE(got.size(), 7U);
  for (std::size_t i = 0; i < 7; ++i) {
    EXPECT_FLOAT_EQ(got[i].ranges()[2], 3.0F + static_cast<float>(i % 3)) << i;
  }
}

TEST(Player, AFasterRateTakesEffectAtOnce) {
  const test::TemporaryDirectory folder;
  write_bag(folder.path() / "bag", 20);
  const auto participant = test::make_participant();
  test::Collector<LaserScan> scans(participant, "/scan", "lossless");
  const Playing playing = play(folder.path() / "bag", ", rate: 0.001", participant);
  playing.host->activate();
  EXPECT_EQ(scans.wait_for(1).size(), 1U);
  playing.player().set_rate(1e6);  // would otherwise play for five hours
  EXPECT_EQ(scans.wait_for(20).size(), 20U);
  EXPECT_THROW(playing.player().set_rate(0.0), ConfigError);
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
  const Playing playing = play(folder.path() / "bag",
                               ", mode: messages, topics: [/strange], rate: 1000000", participant);
  playing.host->activate();
  std::unique_lock lock(mutex);
  changed.wait_for(lock, std::chrono::seconds(20), [&] { return got.size() >= 3; });
  EXPECT_EQ(got, std::vector(3, unknown));
  EXPECT_EQ(participant->published_topics().count("/other"), 0U);
  EXPECT_TRUE(participant->published_topics().at("/strange").transient_local);
}

}  // namespace
}  // namespace strata::player
