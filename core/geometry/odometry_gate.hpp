// SPDX-License-Identifier: Apache-2.0
/// What odometry says of the way from scan to scan, and whether it says anything: the one gate
/// through which the readings of a run go before the localizer or the tracker of SLAM uses them.
#pragma once

#include <optional>

#include "core/base/time.hpp"
#include "core/geometry/odometry_noise.hpp"
#include "core/geometry/pose2.hpp"

namespace strata {

/// The motion since the last reading that was believed.
struct OdometryStep {
  enum class Kind {
    kTold,     ///< the motion since the last reading, and so that of scans without one in between
    kFirst,    ///< of the run: there is no way behind it, with a reading or without
    kMissing,  ///< no reading, or one that is not finite: the next reading may tell
    kUntold,   ///< the first reading after a way that none tells
    kJumped,   ///< further than a robot can come, or back to zero: it was reset, the way is untold
  };
  Kind kind = Kind::kFirst;
  Pose2 motion;  ///< before_from_now; identity unless told
};

/// Readings of one run, in order. A scan without a reading is bridged by that of the next with one.
/// Where the way in between was found otherwise, from scans, moved_otherwise() takes it off, since
/// it would be added twice. O(1).
class OdometryGate {
 public:
  OdometryGate() = default;
  explicit OdometryGate(const OdometryLimits& limits) : limits_(limits) {}

  /// A new run: its first reading carries no motion, as none is before it.
  void reset() { *this = OdometryGate(limits_); }
  /// The next scan's reading; null for none. Stamps that go back count as no time.
  [[nodiscard]] OdometryStep pass(Stamp stamp, const Pose2* odom_from_robot);
  /// Since the last reading the robot has moved so, as found without one: before_from_now.
  void moved_otherwise(const Pose2& motion) {
    if (last_odom_) last_odom_ = *last_odom_ * motion;
  }
  /// ... or nobody knows how: the next reading does not tell either.
  void forget_motion() { last_odom_.reset(); }

  /// For saved states; the limits are the constructor's.
  template <class Self, class Archive>
  static void state(Self& self, Archive& archive) {
    archive(self.last_odom_);
    archive(self.last_stamp_);
    archive(self.has_begun_);
  }

 private:
  OdometryLimits limits_;
  std::optional<Pose2> last_odom_;
  Stamp last_stamp_;
  bool has_begun_ = false;  ///< some scan came
};

}  // namespace strata
