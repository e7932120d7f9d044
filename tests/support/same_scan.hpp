// SPDX-License-Identifier: Apache-2.0
/// Scans that must be the same to the bit.
#pragma once

#include <gtest/gtest.h>

#include "core/scan/scan.hpp"
#include "tests/support/same_bits.hpp"

namespace strata::test {

inline void expect_same_scan(const Scan& a, const Scan& b) {
  EXPECT_EQ(a.stamp, b.stamp);
  EXPECT_EQ(a.angle_min_rad, b.angle_min_rad);
  EXPECT_EQ(a.angle_increment_rad, b.angle_increment_rad);
  EXPECT_EQ(a.time_increment_s, b.time_increment_s);
  EXPECT_EQ(a.scan_time_s, b.scan_time_s);
  EXPECT_EQ(a.range_min_m, b.range_min_m);
  EXPECT_EQ(a.range_max_m, b.range_max_m);
  EXPECT_TRUE(same_bits(a.ranges_m, b.ranges_m));
  EXPECT_EQ(a.robot_from_laser, b.robot_from_laser);
}

}  // namespace strata::test
