// SPDX-License-Identifier: Apache-2.0
#include "components/player/player.hpp"

#include <gtest/gtest.h>

#include "components/convert/scan_messages.hpp"
#include "components/log/bag.hpp"
#include "components/log/log_reader.hpp"
#include "components/player/register.hpp"
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
  LogPlayer player(observations, {[](const auto&) {}, into(tf, now), [](const auto&) {},
                                  into(odometry, now), into(scan, now)});
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

}  // namespace
}  // namespace strata::player
