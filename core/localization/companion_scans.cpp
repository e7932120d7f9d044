// SPDX-License-Identifier: Apache-2.0
#include "core/localization/companion_scans.hpp"

#include <algorithm>
#include <cstddef>

namespace strata::localization {
namespace {

constexpr double kLongestAgoS = 0.5;
/// More than a robot has: then it is a mounting that is measured anew with every scan.
constexpr std::size_t kMostScanners = 8;

}  // namespace

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
  if (kept_.size() >= kMostScanners) kept_.clear();
  kept_.push_back({{observation, {}, {}}, true});
}

const std::vector<CompanionScans::Companion*>& CompanionScans::take(const Observation& now) {
  taken_.clear();
  for (Kept& kept : kept_) {
    Companion& companion = kept.companion;
    const Observation& then = companion.observation;
    const double ago_s = (now.scan.stamp - then.scan.stamp).seconds();
    const bool is_own = then.scan.robot_from_laser == now.scan.robot_from_laser;
    const bool is_recent = then.run == now.run && ago_s >= 0.0 && ago_s <= kLongestAgoS;
    const bool is_told = (then.has_odometry && now.has_odometry) || ago_s == 0.0;
    if (kept.is_fresh && !is_own && is_recent && is_told) {
      companion.now_from_then = then.has_odometry && now.has_odometry
                                    ? between(now.odom_from_robot, then.odom_from_robot)
                                    : Pose2{};
      companion.scan = then.scan;
      companion.scan.robot_from_laser = companion.now_from_then * then.scan.robot_from_laser;
      taken_.push_back(&companion);
    }
    kept.is_fresh = false;
  }
  return taken_;
}

}  // namespace strata::localization
