// SPDX-License-Identifier: Apache-2.0
#include "tools/simulate/random_floor.hpp"

#include <algorithm>
#include <cstdint>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "tools/simulate/simulation.hpp"
#include "tools/simulate/truth.hpp"
#include "tools/simulate/world.hpp"

namespace strata::simulate {
namespace {

constexpr RandomFloorOptions kTwoDays{.days = 2, .has_new_boxes = true};
constexpr std::uint64_t kFloors = 12;

TEST(RandomFloor, IsTheSameForTheSameSeedAndAnotherForAnother) {
  const ScenarioConfig a = random_floor(7, {});
  const ScenarioConfig b = random_floor(7, {});
  const ScenarioConfig c = random_floor(8, {});
  EXPECT_EQ(a.robot.route, b.robot.route);
  EXPECT_EQ(a.boxes.size(), b.boxes.size());
  EXPECT_NE(a.robot.route, c.robot.route);
}

TEST(RandomFloor, KeepsTheRobotClearOfEverythingAndItsRouteWhole) {
  for (std::uint64_t seed = 1; seed <= kFloors; ++seed) {
    const ScenarioConfig floor = random_floor(seed, kTwoDays);
    const Simulation simulation = simulate(floor, seed);
    for (std::size_t d = 0; d < simulation.days.size(); ++d) {
      const SimulatedDay& day = simulation.days[d];
      for (const SimulatedScan& scan : day.scans) {
        const double time_s = (scan.observation.scan.stamp - day.begin).seconds();
        const Eigen::Vector2d robot = scan.map_from_robot.translation();
        for (const Segment& wall : simulation.walls) {
          ASSERT_GT(distance_to_segment(robot, wall), 0.2) << "floor " << seed;
        }
        for (const ChangeableObject& object : simulation.objects) {
          for (const Segment& s : object.shapes[object.state_at(static_cast<int>(d) + 1, time_s)]) {
            ASSERT_GT(distance_to_segment(robot, s), 0.2) << object.id << ", floor " << seed;
          }
        }
      }
      const auto& route = floor.robot.route;
      const Eigen::Vector2d goal(route[route.size() - 2], route.back());
      EXPECT_LT((day.scans.back().map_from_robot.translation() - goal).norm(), 0.35);
    }
  }
}

TEST(RandomFloor, EntersEveryRoomAndHasWhatChanges) {
  std::size_t doors = 0;
  std::size_t boxes = 0;
  for (std::uint64_t seed = 1; seed <= kFloors; ++seed) {
    const ScenarioConfig floor = random_floor(seed, kTwoDays);
    // Each cut leaves two pieces of wall and makes one room more; the first wall goes round all.
    const std::size_t rooms = (floor.walls.size() - 1) / 2 + 1;
    // From the middle of a room to that of the next there are two points beside the passage.
    std::set<std::pair<double, double>> middles;
    for (std::size_t i = 0; i + 1 < floor.robot.route.size(); i += 6) {
      middles.insert({floor.robot.route[i], floor.robot.route[i + 1]});
    }
    EXPECT_EQ(middles.size(), rooms) << "floor " << seed;
    EXPECT_GE(rooms, 4U) << "floor " << seed;
    doors += floor.doors.size();
    boxes += floor.boxes.size();
  }
  EXPECT_GE(doors, 2 * kFloors);
  EXPECT_GE(boxes, 2 * kFloors);
}

TEST(RandomFloor, ShowsNewBoxesOnTheLastDayOnly) {
  std::size_t seen = 0;
  for (std::uint64_t seed = 1; seed <= kFloors; ++seed) {
    const Simulation simulation = simulate(random_floor(seed, kTwoDays), seed);
    for (const ChangeableObject& object : simulation.objects) {
      if (object.id.rfind("new_", 0) != 0) continue;
      ++seen;
      EXPECT_EQ(object.states[object.state_at(1, 1e9)], "absent") << object.id;
      EXPECT_NE(object.states[object.state_at(2, 0.0)], "absent") << object.id;
    }
  }
  EXPECT_GE(seen, kFloors);
}

}  // namespace
}  // namespace strata::simulate
