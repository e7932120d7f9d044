// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "core/geometry/angle.hpp"
#include "memory/levels/virtual_scan.hpp"
#include "tests/memory/levels/room_scans.hpp"

namespace strata::memory {
namespace {

using room_scans::kBins;
using room_scans::kPi;
using room_scans::observe;
using room_scans::room;
using room_scans::transform;

constexpr float kNoReturn = std::numeric_limits<float>::infinity();

/// The room by a scanner that reaches 3.9 m: the wall at x = 5 is out of its reach ahead.
PosedScan observe_nearby(const Pose2& pose) {
  PosedScan posed = observe(room, pose, 720, 2.0 * kPi);
  posed.scan.range_max_m = 3.9F;
  return posed;
}

// Closed form: beams end on a circle about the laser, of which a node a behind it sees
// sqrt(reach^2 - (a sin)^2) + a cos; one range bin less is said.
TEST(VirtualScan, SaysHowFarTheWayIsFreeWhereTheScannerDoesNotReach) {
  const Eigen::Vector2d node(-0.4, 0.0);
  const VirtualScan result = transform(observe_nearby({0.0, 0.0, 0.0}), node);
  int free_ways = 0;
  for (int a = 0; a < 360; ++a) {
    const double bearing = wrap_angle(kBins.center_bearing_rad(a));
    const float range = result[static_cast<std::size_t>(a)];
    if (std::abs(bearing) < 0.4) {
      const double aside = 0.4 * std::sin(bearing);
      const double end_m = std::sqrt(3.9 * 3.9 - aside * aside) + 0.4 * std::cos(bearing);
      EXPECT_NEAR(static_cast<double>(range), kBins.range_bin_m() - end_m, 1e-3) << a;
      ++free_ways;
    }
    EXPECT_LT(-static_cast<double>(range), room(node, bearing)) << a;
  }
  EXPECT_GT(free_ways, 40);
}

TEST(VirtualScan, SaysSoOnlyOfAScannerWhoseReachIsKnown) {
  PosedScan scan = observe_nearby({0.0, 0.0, 0.0});
  for (float& range : scan.scan.ranges_m) range = range < 3.9F ? range : kNoReturn;
  const auto free_ways = [&](const PolarBins& bins, const VisibilityConfig& config) {
    VirtualScan result;
    VirtualScanner(bins, config).transform(scan, {-0.4, 0.0}, result);
    return std::count_if(result.begin(), result.end(), [](float range) { return range < 0.0F; });
  };
  EXPECT_GT(free_ways(kBins, {}), 50);
  EXPECT_GT(free_ways({360, 252, 8.0}, {}), 50);
  EXPECT_EQ(free_ways({360, 253, 8.0}, {}), 0);  // no number is left for it
  VisibilityConfig distrust;
  distrust.trust_no_return = false;
  EXPECT_EQ(free_ways(kBins, distrust), 0);
  scan.scan.range_max_m = 0.0F;
  EXPECT_EQ(free_ways(kBins, {}), 0);
}

// Two beams without return say nothing, three do.
TEST(VirtualScan, TakesThreeBeamsWithoutReturnInARowAtTheirWord) {
  const Pose2 pose{0.0, 0.0, 0.0};
  for (const std::size_t count : {2U, 3U}) {
    PosedScan scan = observe(room, pose, 720, 2.0 * kPi);
    scan.scan.range_max_m = 6.5F;
    for (std::size_t i = 0; i < count; ++i) scan.scan.ranges_m[540 + i] = kNoReturn;  // at +y
    const VirtualScan result = transform(scan, pose.translation());
    const auto free_ways =
        std::count_if(result.begin(), result.end(), [](float range) { return range < 0.0F; });
    EXPECT_EQ(free_ways > 0, count == 3) << count;
  }
}

// Of 720 beams every tenth drops out: the others without return may have as well.
TEST(VirtualScan, DoesNotBelieveAScannerWhoseReturnsDropOutByThemselves) {
  PosedScan scan = observe_nearby({0.0, 0.0, 0.0});
  EXPECT_FALSE(drops_returns(scan.scan));
  PosedScan seldom = scan;
  for (std::size_t i = 0; i < 720; i += 40) seldom.scan.ranges_m[i] = kNoReturn;
  EXPECT_FALSE(drops_returns(seldom.scan));
  for (std::size_t i = 0; i < 720; i += 10) scan.scan.ranges_m[i] = kNoReturn;
  EXPECT_TRUE(drops_returns(scan.scan));
  const VirtualScan result = transform(scan, {-0.4, 0.0});
  EXPECT_TRUE(std::none_of(result.begin(), result.end(), [](float range) { return range < 0.0F; }));
}

}  // namespace
}  // namespace strata::memory
