// SPDX-License-Identifier: Apache-2.0
/// How far odometry may be off over a way.
#pragma once

#include "core/base/config.hpp"
#include "core/geometry/pose2_gaussian.hpp"

namespace strata {

/// Standard deviations that grow with the motion. The defaults are those of one step between two
/// scans.
struct OdometryNoiseConfig {
  double floor_m = 0.05;
  double per_metre_m = 0.50;
  double floor_rad = 0.05;
  double per_metre_rad = 0.05;
  double per_radian_rad = 0.10;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("floor_m", c.floor_m, {.doc = "least position noise", .unit = "m", .min = 1e-4});
    v.field("per_metre_m", c.per_metre_m,
            {.doc = "position noise per metre driven", .unit = "m/m", .min = 0.0});
    v.field("floor_rad", c.floor_rad, {.doc = "least heading noise", .unit = "rad", .min = 1e-4});
    v.field("per_metre_rad", c.per_metre_rad,
            {.doc = "heading noise per metre driven", .unit = "rad/m", .min = 0.0});
    v.field("per_radian_rad", c.per_radian_rad,
            {.doc = "heading noise per radian turned", .unit = "rad/rad", .min = 0.0});
  }
};

/// from_from_to with the covariance that the config gives it, diagonal in frame `from`. way_m:
/// length of the path driven, at least the distance between the two; the turn is the net one.
[[nodiscard]] Pose2Gaussian odometry_step(const Pose2& from_from_to, double way_m,
                                          const OdometryNoiseConfig& config);

}  // namespace strata
