// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/verdicts.hpp"

#include <gtest/gtest.h>

#include "core/base/error.hpp"

namespace strata::experiments {
namespace {

TEST(Verdicts, CountsARightPoseAsNotLostAndAKidnappedRobotAsLost) {
  const VerdictWorld world = world_of_office(101);
  const VerdictCounts counts = count_verdicts(world, "patch", 4, 1);
  EXPECT_GT(counts.scans, 100U);
  EXPECT_LE(counts.scans, world.observations.size());
  EXPECT_EQ(counts.lost, 0U);
  EXPECT_GE(counts.kidnapped, 1U);
  EXPECT_LE(counts.kidnapped, 4U);
  EXPECT_GE(counts.lost_ever, 1U);
  EXPECT_EQ(count_verdicts(world, "patch", 0, 1).kidnapped, 0U);
}

TEST(Verdicts, OnlyScansNearTheTruthCountAsRight) {
  VerdictWorld world = world_of_office(101);
  const std::size_t right = count_verdicts(world, "filtered", 0, 1).scans;
  VerdictWorld half = world;
  for (std::size_t i = world.truths.size() / 2; i < world.truths.size(); ++i) {
    half.truths[i].reset();
    if (world.truths[i]) world.truths[i]->x += 2.0;
  }
  const std::size_t in_first_half = count_verdicts(half, "filtered", 0, 1).scans;
  EXPECT_LT(in_first_half, right);
  EXPECT_EQ(count_verdicts(world, "filtered", 0, 1).scans, in_first_half);
}

TEST(Verdicts, ADriveWithoutTruthIsRefused) {
  VerdictWorld world = world_of_office(101);
  world.truths.assign(world.observations.size(), std::nullopt);
  EXPECT_THROW((void)count_verdicts(world, "filtered", 1, 1), InputError);
}

}  // namespace
}  // namespace strata::experiments
