// SPDX-License-Identifier: Apache-2.0
/// How far odometry, or the matches that go on from it, may be off over a way.
///
/// Two models. Over one step the standard deviation grows with the step: what odometry counts wrong
/// it counts wrong all along (OdometryNoiseConfig). Over many steps with errors of their own it
/// grows with the square root of the way (PathNoiseConfig). The particle filter draws from a third,
/// of the two turns and the way between (localization::MotionModelConfig).
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
            {.doc = "position noise per metre driven",
             .unit = "m/m",
             .min = 0.0,
             .when = "the odometry is better than most: lower it; wheels slip: raise it"});
    v.field("floor_rad", c.floor_rad, {.doc = "least heading noise", .unit = "rad", .min = 1e-4});
    v.field("per_metre_rad", c.per_metre_rad,
            {.doc = "heading noise per metre driven", .unit = "rad/m", .min = 0.0});
    v.field("per_radian_rad", c.per_radian_rad,
            {.doc = "heading noise per radian turned",
             .unit = "rad/rad",
             .min = 0.0,
             .when = "as per_metre_m, for turning"});
  }
};

/// Standard deviations per square root of a metre: the random walk of many steps.
struct PathNoiseConfig {
  double per_root_metre_m = 0.01;
  double per_root_metre_rad = 0.003;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("per_root_metre_m", c.per_root_metre_m,
            {.doc = "position noise of a metre", .unit = "m", .min = 1e-4});
    v.field("per_root_metre_rad", c.per_root_metre_rad,
            {.doc = "heading noise of a metre", .unit = "rad", .min = 1e-4});
  }
};

/// from_from_to with the covariance that the config gives it, diagonal in frame `from`.
/// path_length_m: length of the path driven, at least the distance between the two; the turn is the
/// net one.
[[nodiscard]] Pose2Gaussian odometry_step(const Pose2& from_from_to, double path_length_m,
                                          const OdometryNoiseConfig& config);

/// What no robot with wheels exceeds, indoors or out; within the slack stamps may be off.
struct OdometryLimits {
  double speed_mps = 5.0;
  double slack_m = 1.0;
  double turn_rps = 6.0;
  double slack_rad = 1.0;
};

/// Whether a robot can have made the step in this time; else its odometry was reset, and says
/// nothing.
[[nodiscard]] bool is_possible(const Pose2& step, double time_s, const OdometryLimits& limits = {});

}  // namespace strata
