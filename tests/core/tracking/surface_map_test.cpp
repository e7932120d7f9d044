// SPDX-License-Identifier: Apache-2.0
#include "core/tracking/surface_map.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "tests/core/registration/room_world.hpp"

namespace strata::slam {
namespace {

/// Along y = 0 and y = 2, far past what is looked at.
std::vector<test::Wall> corridor() { return {{-50.0, 0.0, 50.0, 0.0}, {-50.0, 2.0, 50.0, 2.0}}; }

/// A map of so many scans with five beams all round, 0.1 m apart along the corridor's middle.
SurfaceMap passed_with_five_beams(int scans) {
  SurfaceMap map(0.05, {});
  for (int i = 0; i < scans; ++i) {
    const Pose2 pose{0.1 * i, 1.0, 0.0};
    const Scan scan = test::scan_of(corridor(), pose, 0.2 * i, 0.0, 1, 5, 2.0 * std::numbers::pi);
    map.add(scan, pose * scan.robot_from_laser, {}, 30.0);
  }
  return map;
}

TEST(SurfaceMap, AHitAmongBeamsFarApartIsNoPlaceToBeMatchedWith) {
  EXPECT_TRUE(passed_with_five_beams(1).field().points().empty());
}

TEST(SurfaceMap, HitsOfBeamsFarApartBecomeAWallAsTheRobotPasses) {
  const SurfaceMap map = passed_with_five_beams(10);
  const registration::SurfacePoint* point = map.field().nearest(0.8, 0.01);
  ASSERT_NE(point, nullptr);
  EXPECT_NEAR(std::abs(point->normal_y), 1.0, 0.01);
  EXPECT_LT(point->tangential, 0.05);
}

TEST(SurfaceMap, BeamsWithoutReturnSayNothingToIt) {
  CellRect touched[2];
  for (const int i : {0, 1}) {
    SurfaceMap map(0.05, {});
    Scan scan = test::scan_of(corridor(), {0.0, 1.0, 0.0}, 0.0, 0.0, 1, 90, 2.0 * std::numbers::pi);
    scan.range_max_m = 3.0F;
    scan.free_range_m = i == 0 ? 0.0F : 12.0F;
    map.add(scan, scan.robot_from_laser, {}, 30.0);
    touched[i] = map.touched();
  }
  EXPECT_FALSE(touched[0].empty());
  EXPECT_EQ(touched[0], touched[1]);
}

}  // namespace
}  // namespace strata::slam
