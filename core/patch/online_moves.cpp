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
  drop_outs_ = DropOutWatch(config_.no_return);
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

std::vector<Pose2> OnlinePatchLearner::poses_by(const PoseOf& pose_of) const {
  std::vector<Pose2> poses;
  poses.reserve(scans_.size());
  std::optional<int> run;
  Pose2 new_from_old;
  for (const PosedScan& scan : scans_) {
    if (run != scan.run) new_from_old = {};
    run = scan.run;
    const std::optional<Pose2> known = pose_of(scan);
    const bool is_known = known && is_finite(*known);
    if (is_known) new_from_old = *known * inverse(scan.map_from_robot);
    poses.push_back(is_known ? *known : new_from_old * scan.map_from_robot);
  }
  return poses;
}

std::optional<std::vector<PosedScan>> OnlinePatchLearner::moved_scans(const PoseOf& pose_of) const {
  const std::vector<Pose2> poses = poses_by(pose_of);
  bool has_moved = false;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    has_moved = has_moved || displacement_m(scans_[i].map_from_robot, poses[i], kLever_m) >=
                                 0.5 * base_.resolution_m();
  }
  if (!has_moved) return std::nullopt;
  std::vector<PosedScan> scans = scans_;
  for (std::size_t i = 0; i < scans.size(); ++i) scans[i].map_from_robot = poses[i];
  return scans;
}

bool OnlinePatchLearner::catch_up_with(const OnlinePatchLearner& other, const PoseOf& pose_of) {
  if (status_.scans_seen < other.first_scan_) return false;
  const std::vector<Pose2> poses = other.poses_by(pose_of);
  for (std::size_t i = status_.scans_seen - other.first_scan_; i < poses.size(); ++i) {
    PosedScan scan = other.scans_[i];
    scan.map_from_robot = poses[i];
    (void)add(std::move(scan));
  }
  return true;
}

bool OnlinePatchLearner::move_scans(const PoseOf& pose_of) {
  std::optional<std::vector<PosedScan>> scans = moved_scans(pose_of);
  if (!scans) return false;
  if (has_forgotten()) {
    scans_ = std::move(*scans);
    return true;
  }
  begin_again();
  for (PosedScan& scan : *scans) (void)add(std::move(scan));
  return true;
}

}  // namespace strata::patch
