// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/odometry_gate.hpp"

#include <algorithm>
#include <cmath>

namespace strata {
namespace {

/// A base that was switched off and on counts from zero, and stands there until it is driven.
constexpr double kAtZero_m = 0.02;
constexpr double kAtZero_rad = 0.01;
/// It takes so long at least; and who was so near would not be misled.
constexpr double kRestart_s = 2.0;
constexpr double kAway_m = 1.0;

/// Not a way that was driven, though a robot could have: odometry has begun anew.
bool has_begun_anew(const Pose2& before, const Pose2& now, double time_s) {
  return time_s >= kRestart_s && std::hypot(now.x, now.y) <= kAtZero_m &&
         std::abs(now.theta) <= kAtZero_rad && std::hypot(before.x, before.y) >= kAway_m;
}

}  // namespace

OdometryStep OdometryGate::pass(Stamp stamp, const Pose2* odom_from_robot) {
  using Kind = OdometryStep::Kind;
  const bool is_first = !has_begun_;
  has_begun_ = true;
  const bool has_reading = odom_from_robot != nullptr && is_finite(*odom_from_robot);
  if (!has_reading) return {is_first ? Kind::kFirst : Kind::kMissing, {}};
  OdometryStep step{is_first ? Kind::kFirst : Kind::kUntold, {}};
  if (last_odom_) {
    const Pose2 motion = between(*last_odom_, *odom_from_robot);
    const double time_s = std::max(0.0, (stamp - last_stamp_).seconds());
    step = {Kind::kJumped, {}};
    if (is_possible(motion, time_s, limits_) &&
        !has_begun_anew(*last_odom_, *odom_from_robot, time_s))
      step = {Kind::kTold, motion};
  }
  last_odom_ = *odom_from_robot;
  last_stamp_ = stamp;
  return step;
}

}  // namespace strata
