// SPDX-License-Identifier: Apache-2.0
// SLAM with scanners of a few beams all round, against the simulator's truth and odometry alone.
#include "tools/laboratory/experiments/few_beams.hpp"

#include <gtest/gtest.h>

namespace strata::experiments {
namespace {

class FewBeams : public ::testing::TestWithParam<int> {};

TEST_P(FewBeams, LeaveThePosesNoWorseThanOdometryAlone) {
  const std::filesystem::path scenarios = STRATA_SCENARIO_DIR;
  for (const char* world : {"corridor_people.yaml", "office.yaml"}) {
    shards::Units units;
    const FewBeamsErrors errors =
        drive_with_few_beams(scenarios / world, GetParam(), 101, 105, units);
    EXPECT_LT(errors.slam_m, errors.odometry_m) << world;
  }
}

INSTANTIATE_TEST_SUITE_P(AllRound, FewBeams, ::testing::Values(12, 16, 32));

}  // namespace
}  // namespace strata::experiments
