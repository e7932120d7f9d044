// SPDX-License-Identifier: Apache-2.0
#include "tools/simulate/simulation.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/geometry/angle.hpp"
#include "tools/simulate/people.hpp"
#include "tools/simulate/robot.hpp"
#include "tools/simulate/truth.hpp"

namespace strata::simulate {
namespace {

ScenarioConfig small_room() {
  return load_scenario(std::string(STRATA_SCENARIO_DIR) + "/empty_room.yaml");
}

bool same_bits(const Simulation& a, const Simulation& b) {
  for (std::size_t d = 0; d < a.days.size(); ++d) {
    if (a.days[d].scans.size() != b.days[d].scans.size()) return false;
    for (std::size_t i = 0; i < a.days[d].scans.size(); ++i) {
      const SimulatedScan& x = a.days[d].scans[i];
      const SimulatedScan& y = b.days[d].scans[i];
      if (x.observation.scan.ranges_m != y.observation.scan.ranges_m ||
          !(x.observation.odom_from_robot == y.observation.odom_from_robot) ||
          !(x.map_from_robot == y.map_from_robot)) {
        return false;
      }
    }
  }
  return true;
}

TEST(Simulation, IsTheSameForTheSameSeedAndAnotherForAnother) {
  const ScenarioConfig scenario = small_room();
  const Simulation first = simulate(scenario, 3);
  EXPECT_TRUE(same_bits(first, simulate(scenario, 3)));
  EXPECT_FALSE(same_bits(first, simulate(scenario, 4)));
}

TEST(Simulation, DaysAreRunsWithStampsInOrderAndANightBetween) {
  const Simulation simulation = simulate(small_room(), 1);
  ASSERT_EQ(simulation.days.size(), 2U);
  EXPECT_GE((simulation.days[1].begin - simulation.days[0].end).seconds(), 60.0);
  for (std::size_t d = 0; d < 2; ++d) {
    Stamp last = simulation.days[d].begin - Duration{1};
    for (const SimulatedScan& scan : simulation.days[d].scans) {
      EXPECT_EQ(scan.observation.run, static_cast<int>(d));
      EXPECT_GT(scan.observation.scan.stamp, last);
      last = scan.observation.scan.stamp;
    }
  }
}

TEST(Simulation, ScansAreWhatTheTruePosesSee) {
  ScenarioConfig scenario = small_room();
  scenario.laser.noise_m = 0.0;
  scenario.laser.drop_probability = 0.0;
  const Simulation simulation = simulate(scenario, 1);
  std::size_t still = 0;
  for (const SimulatedDay& day : simulation.days) {
    for (const SimulatedScan& scan : day.scans) {
      const Scan& s = scan.observation.scan;
      const Pose2 laser = scan.map_from_robot * s.robot_from_laser;
      for (std::size_t beam = 0; beam < s.size(); ++beam) {
        if (scan.sources[beam] != BeamSource::kStill) continue;
        const double range = static_cast<double>(s.ranges_m[beam]);
        const double angle = s.bearing_rad(beam);
        const Eigen::Vector2d end =
            laser * Eigen::Vector2d(range * std::cos(angle), range * std::sin(angle));
        double nearest = 1e9;
        for (const Segment& wall : simulation.walls) {
          nearest = std::min(nearest, distance_to_segment(end, wall));
        }
        ASSERT_LT(nearest, 1e-5);
        ++still;
      }
    }
  }
  EXPECT_GT(still, 1000U);
}

TEST(Simulation, TruthAndOdometryGoOnOverNight) {
  const Simulation simulation = simulate(small_room(), 1);
  const SimulatedScan& evening = simulation.days[0].scans.back();
  const SimulatedScan& morning = simulation.days[1].scans.front();
  // At most the way of one scan period lies between.
  EXPECT_LT(translation_distance(evening.map_from_robot, morning.map_from_robot), 0.2);
  EXPECT_LT(translation_distance(evening.observation.odom_from_robot,
                                 morning.observation.odom_from_robot),
            0.2);
}

TEST(Odometry, WithoutNoiseIsTheTruthInItsOwnFrame) {
  RobotConfig robot = small_room().robot;
  robot.trans_noise = robot.rot_noise = robot.drift_rad_per_sqrt_m = 0.0;
  robot.scale_stddev = robot.turn_scale_stddev = 0.0;
  const auto truth = drive(robot, first_pose(robot));
  const auto odom = odometry(robot, truth, Pose2{}, 1, 1);
  ASSERT_EQ(odom.size(), truth.size());
  const Pose2 expected = between(truth.front(), truth.back());
  EXPECT_LT(translation_distance(odom.back(), expected), 1e-9);
  EXPECT_NEAR(angle_difference(odom.back().theta, expected.theta), 0.0, 1e-9);
}

TEST(Odometry, NoiseHasTheConfiguredMoments) {
  RobotConfig robot;
  robot.route = {0, 0, 4, 0};
  robot.rot_noise = robot.drift_rad_per_sqrt_m = robot.turn_scale_stddev = 0.0;
  robot.scale_stddev = 0.03;
  robot.trans_noise = 0.02;
  const auto truth = drive(robot, first_pose(robot));
  const double length = truth.back().x;
  double sum = 0.0;
  double squares = 0.0;
  constexpr int kDays = 2000;
  for (int day = 1; day <= kDays; ++day) {
    const double error = odometry(robot, truth, Pose2{}, 9, day).back().x - length;
    sum += error;
    squares += error * error;
  }
  const double variance = 0.03 * 0.03 * length * length + 0.02 * 0.02 * length;
  EXPECT_NEAR(sum / kDays, 0.0, 4.0 * std::sqrt(variance / kDays));
  EXPECT_NEAR(squares / kDays, variance, 4.0 * variance * std::sqrt(2.0 / kDays));
}

TEST(Drive, ReachesEveryWaypointInOrderAndStaysBelowItsSpeed) {
  const RobotConfig robot = small_room().robot;
  const auto poses = drive(robot, first_pose(robot));
  std::size_t next = 0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    ASSERT_LE(translation_distance(poses[i - 1], poses[i]), robot.speed_mps * kDriveStep_s + 1e-12);
    if (next < 3 &&
        (Eigen::Vector2d(robot.route[2 * next], robot.route[2 * next + 1]) - poses[i].translation())
                .norm() < robot.reach_m) {
      ++next;
    }
  }
  EXPECT_EQ(next, 3U);
}

TEST(People, KeepTheirDistanceAndComeBack) {
  ScenarioConfig scenario = small_room();
  PersonConfig person;
  person.path = {0, 0, 10, 0};
  scenario.people = {person};
  const People people(scenario, 1, 1);
  double min_x = 1e9;
  double max_x = -1e9;
  for (double t = 0.0; t < 60.0; t += 0.1) {
    const Eigen::Vector2d robot(5.0, 0.05);
    const auto legs = people.legs_at(t, robot);
    ASSERT_EQ(legs.size(), 2U);
    const Eigen::Vector2d middle = 0.5 * (legs[0].center + legs[1].center);
    EXPECT_GE((middle - robot).norm(), scenario.robot.personal_space_m - 1e-9);
    min_x = std::min(min_x, middle.x());
    max_x = std::max(max_x, middle.x());
  }
  EXPECT_NEAR(min_x, 0.0, 0.2);
  EXPECT_NEAR(max_x, 10.0, 0.2);
}

TEST(Truth, RecordsEveryStateOverTime) {
  const Simulation simulation = simulate(small_room(), 1);
  const auto json = nlohmann::json::parse(states_json(simulation));
  ASSERT_EQ(json["objects"].size(), 2U);
  const auto& door = json["objects"][0];
  EXPECT_EQ(door["id"], "door");
  ASSERT_EQ(door["timeline"].size(), 3U);
  EXPECT_EQ(door["timeline"][0]["state"], "closed");
  EXPECT_EQ(door["timeline"][1]["state"], "open");
  EXPECT_DOUBLE_EQ(door["timeline"][1]["time_s"].get<double>(), 1004.0);
  EXPECT_EQ(door["timeline"][2]["state"], "ajar");
  EXPECT_EQ(door["timeline"][2]["day"], 2);
  EXPECT_EQ(door["timeline"][2]["time_s"], json["days"][1]["begin_s"]);
  EXPECT_EQ(json["objects"][1]["states"], nlohmann::json::parse(R"(["corner", "side", "absent"])"));
}

}  // namespace
}  // namespace strata::simulate
