// SPDX-License-Identifier: Apache-2.0
/// The committed scenarios: they load, nobody drives through a wall, and they hold what they
/// promise.
#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "tools/simulate/simulation.hpp"
#include "tools/simulate/truth.hpp"

namespace strata::simulate {
namespace {

std::string scenario_file(const std::string& name) {
  return std::string(STRATA_SCENARIO_DIR) + "/" + name + ".yaml";
}

class CommittedScenario : public testing::TestWithParam<const char*> {};

TEST_P(CommittedScenario, KeepsTheRobotClearOfEverything) {
  for (const std::uint64_t seed : {1U, 101U}) {
    const Simulation simulation = simulate(load_scenario(scenario_file(GetParam())), seed);
    for (std::size_t d = 0; d < simulation.days.size(); ++d) {
      const SimulatedDay& day = simulation.days[d];
      for (const SimulatedScan& scan : day.scans) {
        const double time_s = (scan.observation.scan.stamp - day.begin).seconds();
        const Eigen::Vector2d robot = scan.map_from_robot.translation();
        for (const Segment& wall : simulation.walls) {
          ASSERT_GT(distance_to_segment(robot, wall), 0.2) << robot.transpose();
        }
        for (const ChangeableObject& object : simulation.objects) {
          for (const Segment& s : object.shapes[object.state_at(static_cast<int>(d) + 1, time_s)]) {
            ASSERT_GT(distance_to_segment(robot, s), 0.2) << object.id << " " << robot.transpose();
          }
        }
      }
    }
  }
}

TEST_P(CommittedScenario, DrivesItsWholeRoute) {
  const ScenarioConfig scenario = load_scenario(scenario_file(GetParam()));
  const Simulation simulation = simulate(scenario, 1);
  const auto& route = scenario.robot.route;
  const Eigen::Vector2d goal(route[route.size() - 2], route.back());
  for (const SimulatedDay& day : simulation.days) {
    EXPECT_LT((day.scans.back().map_from_robot.translation() - goal).norm(), 0.35);
    EXPECT_LT((day.end - day.begin).seconds(), 130.0);
  }
}

INSTANTIATE_TEST_SUITE_P(All, CommittedScenario,
                         testing::Values("office", "corridor_box", "empty_room"));

class Year : public testing::Test {
 protected:
  static ScenarioConfig scenario(int days) {
    ScenarioConfig config = load_scenario(scenario_file("year"));
    config.days = days;
    return config;
  }
};

TEST_F(Year, IsDrivenClearOfEverythingWhereverItStands) {
  Simulator simulator(scenario(1), 1);
  const SimulatedDay day = simulator.next_day();
  double path_m = 0.0;
  for (std::size_t i = 0; i < day.scans.size(); i += 5) {
    const Eigen::Vector2d robot = day.scans[i].map_from_robot.translation();
    if (i > 0) path_m += (robot - day.scans[i - 5].map_from_robot.translation()).norm();
    for (const Segment& wall : simulator.world().walls) {
      ASSERT_GT(distance_to_segment(robot, wall), 0.2) << robot.transpose();
    }
    for (const ChangeableObject& object : simulator.world().objects) {
      for (const auto& shape : object.shapes) {
        for (const Segment& s : shape) {
          ASSERT_GT(distance_to_segment(robot, s), 0.2) << object.id << " " << robot.transpose();
        }
      }
    }
  }
  EXPECT_GE(day.scans.size(), 3000U);
  EXPECT_GE(path_m, 150.0);
}

TEST_F(Year, HasDoorsByTimeOfDayBoxesByTheWeekAndFurnitureTwice) {
  const int days = 365;
  const Simulator simulator(scenario(days), 1);
  for (const ChangeableObject& object : simulator.world().objects) {
    int moves = 0;  // from one day's end to the next
    std::vector<int> when;
    for (int day = 2; day <= days; ++day) {
      if (object.state_at(day, 200.0) == object.state_at(day - 1, 200.0)) continue;
      ++moves;
      when.push_back(day);
    }
    if (object.id == "door_south_1") {
      EXPECT_EQ(moves, 0);
      for (int day = 1; day <= days; ++day) {
        ASSERT_NE(object.state_at(day, 50.0), object.state_at(day, 100.0)) << day;
      }
    } else if (object.id == "table_north") {
      EXPECT_THAT(when, testing::ElementsAre(122, 244));
    } else if (object.id.starts_with("box")) {
      EXPECT_GT(moves, 20) << object.id;
      EXPECT_LE(moves, 52) << object.id;
      for (const int day : when) ASSERT_EQ((day - when.front()) % 7, 0) << object.id;
    }
  }
}

TEST(Simulator, GivesTheDaysOfAWholeSimulation) {
  const ScenarioConfig config = load_scenario(scenario_file("empty_room"));
  const Simulation whole = simulate(config, 3);
  Simulator simulator(config, 3);
  for (const SimulatedDay& expected : whole.days) {
    const SimulatedDay day = simulator.next_day();
    ASSERT_EQ(day.scans.size(), expected.scans.size());
    EXPECT_EQ(day.begin, expected.begin);
    EXPECT_EQ(day.scans.back().observation.scan.ranges_m,
              expected.scans.back().observation.scan.ranges_m);
    EXPECT_EQ(day.scans.back().observation.odom_from_robot,
              expected.scans.back().observation.odom_from_robot);
  }
}

TEST(CorridorBox, HidesAllButWallsAndTheBoxInItsMiddle) {
  ScenarioConfig scenario = load_scenario(scenario_file("corridor_box"));
  scenario.laser.noise_m = 0.0;
  const Simulation simulation = simulate(scenario, 1);
  std::size_t in_the_middle = 0;
  for (const SimulatedDay& day : simulation.days) {
    for (const SimulatedScan& scan : day.scans) {
      const Pose2& pose = scan.map_from_robot;
      if (pose.x < 14.5 || pose.x > 21.5) continue;
      ++in_the_middle;
      const Scan& s = scan.observation.scan;
      const Pose2 laser = pose * s.robot_from_laser;
      for (std::size_t beam = 0; beam < s.size(); ++beam) {
        if (scan.sources[beam] != BeamSource::kStill) continue;
        const double range = static_cast<double>(s.ranges_m[beam]);
        const double angle = s.bearing_rad(beam);
        const double y =
            (laser * Eigen::Vector2d(range * std::cos(angle), range * std::sin(angle))).y();
        ASSERT_LT(std::min(std::abs(y), std::abs(y - 2.0)), 1e-5);
      }
    }
  }
  EXPECT_GT(in_the_middle, 100U);
}

TEST(CorridorBox, TestsWithEveryPlaceOverTheSeeds) {
  const ScenarioConfig scenario = load_scenario(scenario_file("corridor_box"));
  std::array<int, 4> seen{};
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const World world(scenario, seed, 100.0);
    ++seen[world.objects()[0].state_at(7, 0.0)];
  }
  EXPECT_GT(seen[0], 0);
  EXPECT_GT(seen[1], 0);
  EXPECT_GT(seen[2], 0);
  EXPECT_EQ(seen[3], 0) << "absent";
}

TEST(Office, HasDoorsBoxesAndPeopleThatAreSeen) {
  const Simulation simulation = simulate(load_scenario(scenario_file("office")), 1);
  EXPECT_GE(std::count_if(simulation.objects.begin(), simulation.objects.end(),
                          [](const auto& object) { return object.kind != "box"; }),
            3);
  std::size_t people = 0;
  std::size_t changeable = 0;
  std::size_t all = 0;
  for (const SimulatedDay& day : simulation.days) {
    for (const SimulatedScan& scan : day.scans) {
      for (const BeamSource source : scan.sources) {
        people += source == BeamSource::kPerson ? 1 : 0;
        changeable += source == BeamSource::kChangeable ? 1 : 0;
        ++all;
      }
    }
  }
  EXPECT_GT(static_cast<double>(people), 0.01 * static_cast<double>(all));
  EXPECT_GT(static_cast<double>(changeable), 0.02 * static_cast<double>(all));
}

TEST(LoadScenario, NamesTheLineOfAMistakeAndTakesOverrides) {
  EXPECT_EQ(load_scenario(scenario_file("empty_room"), {"laser.beams=5"}).laser.beams, 5);
  try {
    (void)load_scenario(scenario_file("empty_room"), {"laser.beems=5"});
    FAIL() << "no error";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("did you mean 'beams'?"));
  }
}

}  // namespace
}  // namespace strata::simulate
