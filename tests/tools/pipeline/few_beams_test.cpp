// SPDX-License-Identifier: Apache-2.0
// SLAM with scanners of a few beams all round, against the simulator's truth and odometry alone.
#include <cstdint>
#include <iostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/geometry/pose2.hpp"
#include "core/slam/slam.hpp"
#include "tools/simulate/simulation.hpp"

namespace strata {
namespace {

/// Mean distance from the truth after one rigid alignment [m].
double error_m(const std::vector<Pose2>& poses, const std::vector<Pose2>& truth) {
  const Pose2 truth_from_map = align(poses, truth);
  double sum_m = 0.0;
  for (std::size_t t = 0; t < poses.size(); ++t) {
    sum_m += translation_distance(truth_from_map * poses[t], truth[t]);
  }
  return sum_m / static_cast<double>(poses.size());
}

struct Errors {
  double slam_m = 0.0;
  double odometry_m = 0.0;
};

Errors drive(const std::string& world, int beams, std::uint64_t seed) {
  simulate::ScenarioConfig scenario =
      simulate::load_scenario(std::string(STRATA_SCENARIO_DIR) + "/" + world, {"days=1"});
  scenario.people.clear();
  scenario.laser.beams = beams;
  scenario.laser.field_of_view_deg = 360.0;
  const simulate::Simulation simulation = simulate::simulate(scenario, seed);
  slam::Slam slam(slam::SlamConfig{});
  std::vector<Pose2> truth;
  std::vector<Pose2> odometry;
  for (const simulate::SimulatedScan& scan : simulation.days[0].scans) {
    slam.add(scan.observation);
    truth.push_back(scan.map_from_robot);
    odometry.push_back(scan.observation.odom_from_robot);
  }
  std::vector<Pose2> found;
  for (const PosedScan& scan : slam.finish().scans) found.push_back(scan.map_from_robot);
  EXPECT_EQ(found.size(), truth.size());
  return {error_m(found, truth), error_m(odometry, truth)};
}

/// Mean errors over the seeds.
Errors drive_all(const std::string& world, int beams, std::uint64_t first, std::uint64_t last) {
  Errors sum;
  int worse = 0;
  for (std::uint64_t seed = first; seed <= last; ++seed) {
    const Errors errors = drive(world, beams, seed);
    sum.slam_m += errors.slam_m;
    sum.odometry_m += errors.odometry_m;
    worse += errors.slam_m > errors.odometry_m ? 1 : 0;
  }
  const auto runs = static_cast<double>(last - first + 1);
  const Errors mean{sum.slam_m / runs, sum.odometry_m / runs};
  std::cout << world << ", " << beams << " beams: " << mean.slam_m << " m, odometry alone "
            << mean.odometry_m << " m; worse than it in " << worse << " of " << runs << " runs\n";
  return mean;
}

class FewBeams : public ::testing::TestWithParam<int> {};

TEST_P(FewBeams, LeaveThePosesNoWorseThanOdometryAlone) {
  for (const char* world : {"corridor_people.yaml", "office.yaml"}) {
    const Errors errors = drive_all(world, GetParam(), 101, 105);
    EXPECT_LT(errors.slam_m, errors.odometry_m) << world;
  }
}

INSTANTIATE_TEST_SUITE_P(AllRound, FewBeams, ::testing::Values(12, 16, 32));

/// The figures of docs/results.md; seeds that no test and no tuning uses.
TEST(FewBeamsFigures, DISABLED_Results) {
  for (const char* world : {"corridor_people.yaml", "office.yaml"}) {
    for (const int beams : {5, 8, 12, 16, 32, 64}) drive_all(world, beams, 4, 13);
  }
}

}  // namespace
}  // namespace strata
