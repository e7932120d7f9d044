// SPDX-License-Identifier: Apache-2.0
// SLAM with its beam filter in a corridor full of people, against the simulator's truth.
#include "tools/laboratory/experiments/among_people.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <map>

#include <gtest/gtest.h>

#include "tools/laboratory/experiments/simulated_slam.hpp"

namespace strata::experiments {
namespace {

using simulate::Simulation;

const std::filesystem::path kScenarios = STRATA_SCENARIO_DIR;

PeopleOutcome learn_in_corridor(std::size_t people, std::uint64_t seed) {
  return learn_among(kScenarios / "corridor_people.yaml", people, seed);
}

/// Seeds that lost more than 1% while the way back was drawn along the corridor by loop closures.
TEST(AmongPeople, WallsLoseFewerThanOneCellInAHundred) {
  EXPECT_LT(learn_in_corridor(1, 104).walls_lost, 0.01);
  EXPECT_LT(learn_in_corridor(10, 107).walls_lost, 0.01);
  EXPECT_LT(learn_in_corridor(10, 108).walls_lost, 0.01);
}

/// Mean difference of the errors along the corridor, on the way out and on the way back, metre by
/// metre.
double passes_apart_m(const Simulation& simulation, const slam::SlamResult& result) {
  const Pose2 truth_from_map = align(found_poses(result), true_poses(simulation));
  struct Pass {
    double sum_m = 0.0;
    double scans = 0.0;
  };
  std::map<int, std::array<Pass, 2>> places;
  for (std::size_t t = 0; t < result.scans.size(); ++t) {
    const Pose2& truth = simulation.days[0].scans[t].map_from_robot;
    Pass& pass = places[static_cast<int>(truth.x)][std::abs(truth.theta) < 1.5 ? 0 : 1];
    pass.sum_m += (truth_from_map * result.scans[t].map_from_robot).x - truth.x;
    pass.scans += 1.0;
  }
  double sum_m = 0.0;
  double count = 0.0;
  for (const auto& [unused, pass] : places) {
    if (pass[0].scans == 0.0 || pass[1].scans == 0.0) continue;
    sum_m += std::abs(pass[0].sum_m / pass[0].scans - pass[1].sum_m / pass[1].scans);
    count += 1.0;
  }
  return sum_m / count;
}

TEST(AmongPeople, TheWayBackAlongACorridorLiesOnTheWayOut) {
  double sum_m = 0.0;
  for (std::uint64_t seed = 101; seed <= 105; ++seed) {
    const Simulation simulation = drive_among(kScenarios / "corridor_people.yaml", 1, seed);
    sum_m += passes_apart_m(simulation, learn_first_day(simulation));
  }
  EXPECT_LT(sum_m / 5.0, 0.045);
}

TEST(AmongPeople, DoNotTellHowFarTheRobotCameBetweenBareWalls) {
  for (const std::uint64_t seed : {101U, 107U}) {
    const Simulation simulation = drive_among(kScenarios / "corridor_endless.yaml", 5, seed);
    EXPECT_LT(aligned_error_m(found_poses(learn_first_day(simulation)), true_poses(simulation)),
              0.3)
        << seed;
  }
}

class AmongPeopleOf : public ::testing::TestWithParam<std::size_t> {};

TEST_P(AmongPeopleOf, TheFilterFindsThemAndClearsTheMap) {
  const PeopleOutcome outcome = learn_in_corridor(GetParam(), 101);
  EXPECT_GT(outcome.person_beams, 300U);
  EXPECT_GE(outcome.precision, 0.90);
  EXPECT_GE(outcome.recall, 0.90);
  EXPECT_LE(10 * outcome.obstacles_filtered, outcome.obstacles_raw);
  EXPECT_LE(2 * outcome.spurious_filtered, outcome.spurious_raw);
  EXPECT_LT(outcome.walls_lost, 0.01);
  EXPECT_LT(outcome.pose_error_m, 0.05);
}

TEST(AmongPeople, NineOfTenCellsThatOnlyPeopleLeftAreCleared) {
  std::size_t raw = 0;
  std::size_t filtered = 0;
  for (std::uint64_t seed = 101; seed <= 103; ++seed) {
    const PeopleOutcome outcome = learn_in_corridor(10, seed);
    raw += outcome.spurious_raw;
    filtered += outcome.spurious_filtered;
  }
  EXPECT_GT(raw, 100U);
  EXPECT_LE(10 * filtered, raw);
}

INSTANTIATE_TEST_SUITE_P(Corridor, AmongPeopleOf, ::testing::Values(1, 5, 10));

}  // namespace
}  // namespace strata::experiments
