// SPDX-License-Identifier: Apache-2.0
#include "core/localization/companion_scans.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

namespace strata::localization {
namespace {

constexpr double kLongestAgoS = 0.5;

bool tells_place(const Observation& observation) {
  return observation.has_odometry && is_finite(observation.odom_from_robot);
}

/// Calls look(beam, place) with the place in a full circle of `directions` that each beam points
/// to, seen from the robot, as if the scanner sat in its middle.
template <class Look>
void for_directions(const Scan& scan, std::size_t directions, const Look& look) {
  const double heading = scan.robot_from_laser.theta;
  for (std::size_t beam = 0; beam < scan.size(); ++beam) {
    const double turns = (heading + scan.bearing_rad(beam)) * (0.5 / std::numbers::pi);
    const double place = (turns - std::floor(turns)) * static_cast<double>(directions);
    look(beam, std::min(static_cast<std::size_t>(place), directions - 1));
  }
}

}  // namespace

void CompanionScans::leave_out_covered(Scan& scan) const {
  for_directions(scan, kDirections, [&](std::size_t beam, std::size_t place) {
    if (is_covered_[place]) scan.ranges_m[beam] = std::numeric_limits<float>::quiet_NaN();
  });
}

std::size_t CompanionScans::cover(const Scan& scan) {
  std::size_t hits = 0;
  for_directions(scan, kDirections, [&](std::size_t beam, std::size_t place) {
    if (scan.kind(beam) != BeamKind::kHit) return;
    is_covered_[place] = true;
    ++hits;
  });
  return hits;
}

void CompanionScans::keep(const Observation& observation) {
  const Pose2& mounting = observation.scan.robot_from_laser;
  const auto own = std::find_if(kept_.begin(), kept_.end(), [&](const Kept& kept) {
    return kept.companion.observation.scan.robot_from_laser == mounting;
  });
  if (own != kept_.end()) {
    own->companion.observation = observation;
    own->is_fresh = true;
    return;
  }
  if (kept_.size() >= kMaxScanners) kept_.clear();
  kept_.push_back({{observation, {}, {}}, true});
}

const std::vector<CompanionScans::Companion*>& CompanionScans::take(const Observation& now) {
  taken_.clear();
  is_covered_.fill(false);
  const std::size_t own = cover(now.scan);
  std::size_t all = own;
  for (Kept& kept : kept_) {
    Companion& companion = kept.companion;
    const Observation& then = companion.observation;
    const double ago_s = (now.scan.stamp - then.scan.stamp).seconds();
    const bool is_own = then.scan.robot_from_laser == now.scan.robot_from_laser;
    const bool is_recent = then.run == now.run && ago_s >= 0.0 && ago_s <= kLongestAgoS;
    const bool has_motion = tells_place(then) && tells_place(now);
    const bool is_told = has_motion || ago_s == 0.0;
    if (kept.is_fresh && !is_own && is_recent && is_told) {
      companion.now_from_then =
          has_motion ? between(now.odom_from_robot, then.odom_from_robot) : Pose2{};
      companion.scan = then.scan;
      companion.scan.robot_from_laser = companion.now_from_then * then.scan.robot_from_laser;
      leave_out_covered(companion.scan);
      const std::size_t hits = cover(companion.scan);
      companion.share = static_cast<double>(hits);
      all += hits;
      taken_.push_back(&companion);
    }
    kept.is_fresh = false;
  }
  const double whole = 1.0 / static_cast<double>(std::max<std::size_t>(all, 1));
  for (Companion* companion : taken_) companion->share *= whole;
  own_share_ = all > 0 ? static_cast<double>(own) * whole : 1.0;
  return taken_;
}

}  // namespace strata::localization
