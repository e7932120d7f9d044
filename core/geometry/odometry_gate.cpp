// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/odometry_gate.hpp"

#include <algorithm>

namespace strata {

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
    if (is_possible(motion, time_s, limits_)) step = {Kind::kTold, motion};
  }
  last_odom_ = *odom_from_robot;
  last_stamp_ = stamp;
  return step;
}

}  // namespace strata
