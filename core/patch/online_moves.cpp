// SPDX-License-Identifier: Apache-2.0
/// What an online learner does when the poses of its scans become known better.
#include <utility>

#include "core/patch/online_learner.hpp"

namespace strata::patch {
namespace {

/// A turn counts as a step of what is so far away.
constexpr double kLever_m = 10.0;

}  // namespace

void OnlinePatchLearner::begin_again() {
  visits_ = VisitStore(base_.resolution_m(), config_.visits, config_.counting, online_.max_visits);
  contradictory_ = Grid<std::uint8_t>(base_.resolution_m(), CellRect{}, 0);
  tracks_.clear();
  scans_.clear();
  reach_m_.clear();
  first_scan_ = 0;
  scan_bytes_ = 0;
  max_sequences_ = online_.max_sequences;
  is_checked_ = false;
  last_check_ = {};
  last_run_ = 0;
  status_ = {};
}

bool OnlinePatchLearner::move_scans(const PoseOf& pose_of) {
  std::vector<Pose2> poses;
  poses.reserve(scans_.size());
  bool has_moved = false;
  std::optional<int> run;
  Pose2 new_from_old;
  for (const PosedScan& scan : scans_) {
    if (run != scan.run) new_from_old = {};
    run = scan.run;
    const std::optional<Pose2> known = pose_of(scan);
    const bool is_known = known && is_finite(*known);
    if (is_known) new_from_old = *known * inverse(scan.map_from_robot);
    poses.push_back(is_known ? *known : new_from_old * scan.map_from_robot);
    has_moved = has_moved || displacement_m(scan.map_from_robot, poses.back(), kLever_m) >=
                                 0.5 * base_.resolution_m();
  }
  if (!has_moved) return false;
  for (std::size_t i = 0; i < scans_.size(); ++i) scans_[i].map_from_robot = poses[i];
  if (first_scan_ > 0) return true;
  std::vector<PosedScan> scans = std::move(scans_);
  begin_again();
  for (PosedScan& scan : scans) (void)add(std::move(scan));
  return true;
}

}  // namespace strata::patch
