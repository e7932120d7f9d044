// SPDX-License-Identifier: Apache-2.0
/// strata::PatchLearner: posed scans and the filtered map in; the patch map out.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>

#include "components/log/set_back_watch.hpp"
#include "components/patch_learner/config.hpp"
#include "components/patch_learner/known_poses.hpp"
#include "components/patch_learner/learner_store.hpp"
#include "components/patch_learner/relearner.hpp"
#include "components/runtime/component.hpp"
#include "components/runtime/pose_watch.hpp"
#include "components/site/learn_limits.hpp"
#include "core/patch/online_learner.hpp"
#include "core/patch/patch_learner.hpp"

namespace strata::patch_learner {

/// In: reflection_filtered, and mapped_scan (lockstep) or online.scan_topic (live). Out: patch_map;
/// at the end of a log the patch map in MAPS. Online (live, or with online.maps) it publishes each
/// changed map, learns again where a trajectory has the scans after a loop closure (on a thread of
/// its own, going on with what it has until that is done), and goes on after a finish.
class PatchLearner final : public runtime::Component {
 public:
  using Component::Component;

 private:
  void on_declare() override { declare_parameters<PatchLearnerComponentConfig>(); }
  void on_configure() override;
  void on_tick() override;
  void on_deactivate() override;
  void on_cleanup() override;
  [[nodiscard]] bool learns() const override { return !is_online_; }
  void on_diagnose(runtime::Health& health) const override;
  void on_finish(const std::filesystem::path& out_dir) override;
  void on_scan(const strata_msgs::msg::LabeledScan& message);
  void on_base(ReflectionGrid filtered);
  void make_online(const ReflectionGrid& base);
  /// Makes the online learner, with what is stored or what its maps were learned from.
  void begin_online(const ReflectionGrid& base);
  /// Of the stored state; false when that was damaged and is set aside.
  bool restore(const ReflectionGrid& base);
  /// The mapper has begun anew since, in a frame of its own.
  void set_other_map_aside(const ReflectionGrid& base);
  /// The scans after the restored state, or all that are left.
  void add_stored_scans(bool is_restored);
  void learn_online(PosedScan scan);
  void on_trajectory(const nav_msgs::msg::Path& message);
  /// Where the newest trajectory has the scan, if that is near the map.
  [[nodiscard]] std::optional<Pose2> known_pose(const PosedScan& scan) const;
  /// Begins to learn again from scans that have moved, unless that was done a moment ago.
  void move_scans();
  /// Goes on with what was learned again, when that is done.
  void take_relearned();
  void have_moved();
  /// The map, when it has changed.
  void publish_if_due();
  void count_areas(const patch::PatchMap& map);

  site::Zones zones_;         ///< as they were when it was configured
  site::LearnLimits limits_;  ///< of these on the map's cells
  PatchLearnerComponentConfig config_;
  std::optional<patch::PatchLearner> learner_;
  std::optional<ReflectionGrid> filtered_;
  std::unique_ptr<patch::OnlinePatchLearner> online_;
  std::optional<Relearner> relearner_;
  std::optional<LearnerStore> store_;
  std::chrono::steady_clock::time_point flushed_;
  runtime::PoseWatch poses_;
  // What follows is for online learning.
  using Clock = std::chrono::steady_clock;
  bool is_online_ = false;
  int first_run_ = 0;            // of the scans that come, after those of `maps`
  std::deque<PosedScan> early_;  // came before there was a map to learn on
  std::uint64_t scans_without_map_ = 0;
  std::optional<Stamp> newest_;            // of the scans that it learned from
  log::SetBackWatch clock_;                // of theirs
  std::optional<KnownPoses> known_poses_;  // of the newest trajectory
  bool has_known_poses_ = false;           // that scans have not been moved to yet
  Clock::time_point relearned_;            // when that began
  Clock::time_point may_move_;
  std::uint64_t moves_ = 0;
  bool has_news_ = false;  // changed and not published yet
  std::optional<Stamp> published_;
  Clock::time_point may_publish_;
  std::size_t submaps_ = 0;
  std::size_t unrecurring_ = 0;
  std::function<void(const strata_msgs::msg::PatchMap&)> publish_map_;
};

}  // namespace strata::patch_learner
