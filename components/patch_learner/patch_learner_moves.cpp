// SPDX-License-Identifier: Apache-2.0
// What the patch learner does when a loop closure moves scans.
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "components/patch_learner/patch_learner.hpp"
#include "components/runtime/share_of_time.hpp"

namespace strata::patch_learner {
namespace {

/// A broken trajectory must not spread scans over a whole town, which takes all memory.
bool is_near(const Pose2& pose, const ReflectionGrid& map) {
  const auto is_between = [&](double value_m, int min, int max) {
    constexpr double kFar_m = runtime::PoseWatch::kFar_m;
    return value_m > min * map.resolution_m() - kFar_m &&
           value_m < max * map.resolution_m() + kFar_m;
  };
  const CellRect& rect = map.rect();
  return is_between(pose.x, rect.min.x, rect.max.x) && is_between(pose.y, rect.min.y, rect.max.y);
}

}  // namespace

void PatchLearner::on_trajectory(const nav_msgs::msg::Path& message) {
  known_poses_.emplace(message);
  has_known_poses_ = true;
  if (online_) move_scans();
}

std::optional<Pose2> PatchLearner::known_pose(const PosedScan& scan) const {
  const std::optional<Pose2> pose = known_poses_->at(scan.scan.stamp);
  return pose && is_near(*pose, *filtered_) ? pose : std::nullopt;
}

void PatchLearner::move_scans() {
  take_relearned();
  const Clock::time_point begin = Clock::now();
  if (!has_known_poses_ || begin < may_move_ || relearner_->is_busy()) return;
  has_known_poses_ = false;
  relearned_ = begin;
  const auto pose_of = [this](const PosedScan& scan) { return known_pose(scan); };
  if (online_->has_forgotten()) {
    if (online_->move_scans(pose_of)) have_moved();
    may_move_ = runtime::next_turn(begin);
    return;
  }
  std::optional<std::vector<PosedScan>> scans = online_->moved_scans(pose_of);
  may_move_ = runtime::next_turn(begin);
  if (scans) relearner_->begin(std::move(*scans), *filtered_);
}

void PatchLearner::take_relearned() {
  if (!relearner_ || relearner_->is_busy()) return;
  std::unique_ptr<patch::OnlinePatchLearner> fresh = relearner_->take();
  if (!fresh) return;
  may_move_ = runtime::next_turn(relearned_);
  const auto pose_of = [this](const PosedScan& scan) { return known_pose(scan); };
  if (!fresh->catch_up_with(*online_, pose_of)) return;
  fresh->set_base(*filtered_);
  online_ = std::move(fresh);
  have_moved();
}

void PatchLearner::have_moved() {
  ++moves_;
  has_news_ = true;
  if (store_) guarded([this] { store_->begin(*online_); });
  publish_if_due();
}

}  // namespace strata::patch_learner
