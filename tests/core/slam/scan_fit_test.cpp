// SPDX-License-Identifier: Apache-2.0
#include "core/slam/scan_fit.hpp"

#include <cstddef>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "core/grid/counting_map.hpp"
#include "tests/core/slam/ring_world.hpp"

namespace strata::slam {
namespace {

/// A block with corridors about it, mapped at the true poses.
struct Mapped {
  std::vector<Pose2> path = test::drive_round(0.1, 30.0);
  std::vector<Observation> log = test::record(test::ring(), path, 0, 5);
  ReflectionGrid map = [this] {
    CountingMap counts(0.05);
    for (std::size_t i = 0; i < log.size(); i += 5) counts.add({0, log[i].scan, path[i], {}});
    return counts.reflection();
  }();
};

TEST(ScanFit, ExplainsAScanWhereItWasTakenAndNotElsewhere) {
  const Mapped mapped;
  for (std::size_t i = 0; i < mapped.log.size(); i += 40) {
    const Pose2& truth = mapped.path[i];
    const ScanFit right = fit_near(mapped.map, mapped.log[i].scan, truth);
    EXPECT_GT(right.inlier_share(), 0.9) << i;
    const Pose2 turned{truth.x, truth.y, truth.theta + 1.0};
    EXPECT_LT(fit_near(mapped.map, mapped.log[i].scan, turned).inlier_share(),
              right.inlier_share() - 0.2)
        << i;
  }
}

TEST(ScanFit, FindsThePlaceNearAWrongOne) {
  const Mapped mapped;
  const std::size_t i = mapped.log.size() / 2;
  const Pose2 wrong = mapped.path[i] * Pose2{0.3, -0.2, 0.1};
  const ScanFit fit = fit_near(mapped.map, mapped.log[i].scan, wrong);
  EXPECT_GT(fit.inlier_share(), 0.9);
  EXPECT_LT(fit_near(mapped.map, mapped.log[i].scan, wrong, {.reach_m = 0.0, .reach_rad = 0.0})
                .inlier_share(),
            0.7);
}

TEST(ScanFit, WithoutHitsOrMapNothingIsExplained) {
  const Mapped mapped;
  Scan blind = mapped.log[0].scan;
  for (float& range_m : blind.ranges_m) range_m = std::numeric_limits<float>::infinity();
  EXPECT_EQ(fit_near(mapped.map, blind, mapped.path[0]).inlier_share(), 0.0);
  EXPECT_EQ(fit_near(ReflectionGrid{}, mapped.log[0].scan, mapped.path[0]).inlier_share(), 0.0);
  const Pose2 far{1000.0, 0.0, 0.0};
  EXPECT_EQ(fit_near(mapped.map, mapped.log[0].scan, far).inlier_share(), 0.0);
}

}  // namespace
}  // namespace strata::slam
