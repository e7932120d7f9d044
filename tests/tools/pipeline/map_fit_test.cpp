// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/map_fit.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/grid/counting_map.hpp"
#include "tools/pipeline/localize_picture.hpp"

namespace strata::pipeline {
namespace {

constexpr double kHalf_m = 3.0;  ///< of the room, which is a square about the origin

/// A known square of 6 m with walls, in a lattice of which the rest is unknown.
ReflectionGrid room() {
  ReflectionGrid map = make_reflection_grid(0.05, {{-200, -200}, {200, 200}});
  for (int y = -62; y < 62; ++y) {
    for (int x = -62; x < 62; ++x) {
      const bool is_wall = std::max(std::abs(x + 0.5), std::abs(y + 0.5)) * 0.05 > kHalf_m;
      map.at({x, y}) = is_wall ? 1.0F : 0.0F;
    }
  }
  return map;
}

/// What a scanner in the middle of a square room sees all round.
Observation scan_of_a_room(double half_m) {
  Observation observation;
  Scan& scan = observation.scan;
  scan.angle_min_rad = -3.1F;
  scan.angle_increment_rad = 0.1F;
  scan.range_max_m = 20.0F;
  for (int i = 0; i < 62; ++i) {
    const double angle = -3.1 + 0.1 * i;
    scan.ranges_m.push_back(static_cast<float>(
        half_m / std::max(std::abs(std::cos(angle)), std::abs(std::sin(angle)))));
  }
  return observation;
}

localization::LocalizationResult at(const Pose2& pose, bool weighed = true) {
  localization::LocalizationResult result;
  result.pose.mean = pose;
  result.weighed = weighed;
  return result;
}

class MapFitOfARoom : public testing::Test {
 protected:
  void see(int scans, double half_m, const Pose2& pose) {
    for (int i = 0; i < scans; ++i) fit_.add(scan_of_a_room(half_m), at(pose), {});
  }
  [[nodiscard]] const LogFit& fit() const { return fit_.fit(); }
  MapFit fit_{room()};
};

TEST_F(MapFitOfARoom, IsExplainedByItsOwnMap) {
  see(20, kHalf_m, {0.0, 0.0, 0.0});
  EXPECT_DOUBLE_EQ(fit().share(FitState::kExplained), 1.0);
  EXPECT_TRUE(fit().is_explained());
  EXPECT_GT(fit().scans.back().score, 0.9);
}

TEST_F(MapFitOfARoom, ContradictsAScanOfASmallerRoom) {
  see(20, 1.5, {0.0, 0.0, 0.0});
  EXPECT_DOUBLE_EQ(fit().share(FitState::kContradicted), 1.0);
  EXPECT_FALSE(fit().is_explained());
  EXPECT_LT(fit().scans.back().score, 0.2);
}

TEST_F(MapFitOfARoom, SaysNothingWhereTheMapKnowsNothing) {
  see(20, 1.5, {7.0, 7.0, 0.0});
  EXPECT_DOUBLE_EQ(fit().share(FitState::kUnknown), 1.0);
  EXPECT_FALSE(fit().is_explained());
}

TEST_F(MapFitOfARoom, GoesByTheLastTenScansTogether) {
  see(12, kHalf_m, {0.0, 0.0, 0.0});
  see(3, 1.5, {0.0, 0.0, 0.0});  // people all round, for a moment
  EXPECT_DOUBLE_EQ(fit().share(FitState::kExplained), 1.0);
  see(3, 1.5, {0.0, 0.0, 0.0});
  EXPECT_EQ(fit().scans.back().fit, FitState::kContradicted);
  see(10, kHalf_m, {0.0, 0.0, 0.0});
  EXPECT_GT(fit().scans.back().score, 0.9);
}

TEST_F(MapFitOfARoom, LeavesOutScansThatWereNotWeighed) {
  fit_.add(scan_of_a_room(1.5), at({}, false), {});
  EXPECT_TRUE(fit().scans.empty());
  EXPECT_TRUE(fit().is_explained()) << "nothing speaks against it";
}

TEST(FitColor, GoesFromRedToGreenAndIsBlueWhereNothingIsKnown) {
  const auto color = [](double score, FitState fit) { return color_of({{}, {}, score, fit}); };
  const report::Color good = color(1.0, FitState::kExplained);
  EXPECT_GT(good.g, good.r + 40);
  const report::Color bad = color(0.0, FitState::kContradicted);
  EXPECT_GT(bad.r, bad.g + 40);
  const report::Color unknown = color(0.9, FitState::kUnknown);
  EXPECT_GT(unknown.b, unknown.r + 40);
}

TEST(MapFit, OfATrajectoryLooksAtTheScansThatHaveAPose) {
  std::vector<Observation> observations;
  std::vector<log::StampedPose> trajectory;
  for (int i = 0; i < 20; ++i) {
    observations.push_back(scan_of_a_room(kHalf_m));
    observations.back().scan.stamp = Stamp{i};
    if (i < 15) trajectory.push_back({Stamp{i}, Pose2{0.0, 0.0, 0.0}});
  }
  const LogFit fit = fit_of_trajectory(room(), observations, trajectory);
  EXPECT_EQ(fit.scans.size(), 15U);
  EXPECT_TRUE(fit.is_explained());
  for (log::StampedPose& at : trajectory) at.pose = {2.0, 1.0, 0.5};
  EXPECT_FALSE(fit_of_trajectory(room(), observations, trajectory).is_explained());
}

}  // namespace
}  // namespace strata::pipeline
