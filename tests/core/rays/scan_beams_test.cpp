// SPDX-License-Identifier: Apache-2.0
#include "core/rays/scan_beams.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace strata::rays {
namespace {

// Its stride did not fit into an integer and became 0: the loop over the beams took all memory.
TEST(ScanBeams, OfAScanWhoseBeamsHardlyDifferInAngleAreFew) {
  Scan scan;
  scan.range_max_m = 10.0F;
  scan.ranges_m.assign(100, 2.0F);
  BeamSelectionConfig config;
  config.min_angle_rad = 0.01;
  for (const float increment : {std::numeric_limits<float>::denorm_min(), 1e-30F, -1e-20F}) {
    scan.angle_increment_rad = increment;
    EXPECT_EQ(select_beams(scan, config).size(), 1U) << increment;
  }
  scan.angle_increment_rad = 0.0F;
  EXPECT_EQ(select_beams(scan, config).size(), 100U) << "an angle of 0 says nothing";
}

}  // namespace
}  // namespace strata::rays
