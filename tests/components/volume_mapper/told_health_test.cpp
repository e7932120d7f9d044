// SPDX-License-Identifier: Apache-2.0
/// Clouds beside a localizer that does not always know where the robot is.
#include "components/volume_mapper/told_health.hpp"

#include <gtest/gtest.h>

#include "tests/components/volume_mapper/robot.hpp"

namespace strata::volume_mapper {
namespace {

Stamp at(double time_s) { return Stamp::from_seconds(time_s); }

TEST(ToldHealth, IsThatOfTheScansBeforeAndAfter) {
  ToldHealth health;
  EXPECT_EQ(health.is_localized(at(1.0), at(1.0)), std::nullopt);
  health.add(at(1.0), true);
  EXPECT_EQ(health.is_localized(at(0.9), at(1.0)), true) << "nothing is known of before";
  EXPECT_EQ(health.is_localized(at(1.0), at(1.1)), std::nullopt);
  health.add(at(2.0), false);
  health.add(at(3.0), true);
  health.add(at(4.0), true);
  EXPECT_EQ(health.is_localized(at(1.0), at(1.0)), true);
  EXPECT_EQ(health.is_localized(at(1.1), at(1.2)), false);
  EXPECT_EQ(health.is_localized(at(2.1), at(2.2)), false);
  EXPECT_EQ(health.is_localized(at(1.0), at(4.0)), false);
  EXPECT_EQ(health.is_localized(at(3.0), at(3.5)), true);
}

TEST(ToldHealth, ForgetsWhatIsOldAndWhatAClockSaidThatWasSetBack) {
  ToldHealth health(10.0);
  health.add(at(100.0), false);
  health.add(at(109.0), true);
  EXPECT_EQ(health.is_localized(at(105.0), at(105.0)), false);
  health.add(at(111.0), true);
  EXPECT_EQ(health.is_localized(at(105.0), at(105.0)), true);
  health.add(at(50.0), true);
  EXPECT_EQ(health.is_localized(at(50.0), at(50.5)), std::nullopt);
}

TEST(VolumeMapper, PassesCloudsOverWhileTheRobotIsNotLocalizedAndWaitsUntilItKnows) {
  Robot robot("publish_period_s: 0, health_topic: localization_health");
  robot.move(1.0, 0.0);
  robot.see(1.5, wall(2.1F));  // nobody knows yet whether the robot is there
  robot.see(2.5, wall(-2.1F));
  robot.see(3.5, wall(1.1F));
  robot.see(4.5, wall(3.1F));
  for (double time_s = 1.5; time_s < 5.1; time_s += 0.5) robot.move(time_s, 0.0);
  robot.tell_health(1.0, true);
  robot.tell_health(2.0, true);
  robot.tell_health(3.0, false);       // ambiguous
  robot.tell_health(4.0, true, true);  // lost
  robot.tell_health(4.1, true);
  robot.tell_health(5.0, true);
  const auto status = robot.status("clouds while not localized", "2");
  EXPECT_EQ(test::value_of(status, "clouds"), "2");
  EXPECT_EQ(test::value_of(status, "clouds without pose"), "0");
  // The map of both: the one of the first may have been overtaken.
  const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  std::vector<Octomap> maps = robot.tick_for(1);
  while (!maps.empty() && !is_occupied(tree_of(maps.back()), 3.35, 0.05, 0.05) &&
         std::chrono::steady_clock::now() < patience) {
    robot.tick();
    maps = robot.wait_for(1);
  }
  ASSERT_FALSE(maps.empty());
  const octomap::OcTree tree = tree_of(maps.back());
  EXPECT_TRUE(is_occupied(tree, 2.35, 0.05, 0.05));
  EXPECT_FALSE(is_occupied(tree, -1.85, 0.05, 0.05));
  EXPECT_FALSE(is_occupied(tree, 1.35, 0.05, 0.05));
  EXPECT_TRUE(is_occupied(tree, 3.35, 0.05, 0.05));
}

TEST(VolumeMapper, SaysThatNobodyTellsItsHealth) {
  Robot robot("publish_period_s: 0, waiting_clouds: 1, health_topic: localization_health");
  robot.move(1.0, 0.0);
  robot.move(2.0, 0.0);
  robot.see(1.3, wall(2.1F));
  robot.see(1.6, wall(2.1F));
  const auto status = robot.status("clouds without localization health", "1");
  EXPECT_EQ(status.message(), "nobody publishes /localization_health: no cloud enters the map");
}

}  // namespace
}  // namespace strata::volume_mapper
