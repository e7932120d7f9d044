// SPDX-License-Identifier: Apache-2.0
// Whether the robot is near where it thinks, by its last scans.
#include "core/localization/place_finder.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/core/localization/box_world.hpp"

namespace strata::localization {
namespace {

using test::BoxWorld;
using test::Drive;

/// A room of 8 m x 5 m with a few things in it, none like the other.
BoxWorld room() {
  return {{-0.3, -0.3, 8.3, 0.0}, {-0.3, 5.0, 8.3, 5.3}, {-0.3, -0.3, 0.0, 5.3},
          {8.0, -0.3, 8.3, 5.3},  {1.0, 3.8, 2.2, 5.0},  {4.0, 0.0, 4.5, 1.4},
          {6.3, 3.0, 7.0, 3.4},   {2.6, 1.5, 2.9, 1.8}};
}

class FindBetter : public testing::Test {
 protected:
  FindBetter() {
    finder_.set_map(test::rasterize(room(), 0.05, {{-6, -6}, {166, 106}}));
    for (int n = 0; n < 5; ++n) {
      const Pose2 motion{0.2, 0.0, 0.1};
      drive_.step(motion);
      finder_.add(motion, drive_.look(room()).scan);
    }
  }
  [[nodiscard]] Pose2 off(double x_m, double y_m, double theta_rad) const {
    return {drive_.truth().x + x_m, drive_.truth().y + y_m, drive_.truth().theta + theta_rad};
  }

  PlaceFinder finder_{PlaceFinderConfig{}};
  Drive drive_{{2.0, 2.6, 0.0}, 3};
};

TEST_F(FindBetter, FindsNothingWhereTheScansFitBest) {
  EXPECT_FALSE(finder_.find_better(drive_.truth(), 1.0, 0.3));
  EXPECT_FALSE(finder_.find_better(off(0.05, -0.05, 0.02), 1.0, 0.3));
}

TEST_F(FindBetter, FindsThePlaceBesideAPoseThatDrifted) {
  for (const Pose2& drifted : {off(0.6, 0.2, 0.0), off(-0.3, 0.5, 0.2), off(0.1, -0.7, -0.2)}) {
    const auto found = finder_.find_better(drifted, 1.0, 0.3);
    ASSERT_TRUE(found);
    EXPECT_LT(translation_distance(found->map_from_robot, drive_.truth()), 0.1);
    EXPECT_NEAR(found->map_from_robot.theta, drive_.truth().theta, 0.05);
  }
}

TEST_F(FindBetter, LooksNoFurtherThanItIsTold) {
  EXPECT_FALSE(finder_.find_better(off(0.7, 0.0, 0.0), 0.4, 0.3));
  const auto turned = finder_.find_better(off(0.0, 0.0, 0.5), 0.4, 0.3);
  if (turned) {
    EXPECT_GT(std::abs(turned->map_from_robot.theta - drive_.truth().theta), 0.15);
  }
}

TEST_F(FindBetter, FindsNothingWithoutScansOrAMap) {
  PlaceFinder without_map{PlaceFinderConfig{}};
  without_map.add({}, drive_.look(room()).scan);
  EXPECT_FALSE(without_map.find_better(drive_.truth(), 1.0, 0.3));
  finder_.forget_scans();
  EXPECT_FALSE(finder_.find_better(off(0.6, 0.2, 0.0), 1.0, 0.3));
}

}  // namespace
}  // namespace strata::localization
