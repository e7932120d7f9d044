// SPDX-License-Identifier: Apache-2.0
/// strata::PatchLearner: posed scans and the filtered map in; the patch map out.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>

#include "components/patch_learner/config.hpp"
#include "components/patch_learner/learner_store.hpp"
#include "components/runtime/component.hpp"
#include "components/runtime/pose_watch.hpp"
#include "core/patch/online_learner.hpp"
#include "core/patch/patch_learner.hpp"

namespace strata::patch_learner {

/// In: mapped_scan (lockstep) or labeled_scan (live), reflection_filtered. Out: patch_map; at the
/// end of a log the patch map in MAPS. Online (online.enabled) it also learns from
/// online.scan_topic in lockstep, publishes each changed map, and goes on after a finish.
class PatchLearner final : public runtime::Component {
 public:
  using Component::Component;

 private:
  void on_declare() override { declare_parameters<PatchLearnerComponentConfig>(); }
  void on_configure() override;
  void on_tick() override;
  void on_deactivate() override;
  void on_cleanup() override;
  [[nodiscard]] bool learns() const override { return !config_.online.enabled; }
  void on_diagnose(runtime::Health& health) const override;
  void on_finish(const std::filesystem::path& out_dir) override;
  void on_scan(const strata_msgs::msg::LabeledScan& message);
  void on_base(ReflectionGrid filtered);
  /// Makes the online learner, with what is stored or what its maps were learned from.
  void begin_online(const ReflectionGrid& base);
  /// False when nothing is stored.
  bool restore(const ReflectionGrid& base);
  void learn_online(PosedScan scan);

  PatchLearnerComponentConfig config_;
  std::optional<patch::PatchLearner> learner_;
  std::optional<ReflectionGrid> filtered_;
  std::optional<patch::OnlinePatchLearner> online_;
  std::optional<LearnerStore> store_;
  std::chrono::steady_clock::time_point flushed_;
  runtime::PoseWatch poses_;
  int first_run_ = 0;                    // online: of the scans that come, after those of `maps`
  std::uint64_t scans_without_map_ = 0;  // online: came before there was a map to learn on
  bool has_news_ = false;                // online: changed and not published yet
  std::optional<Stamp> published_;
  std::size_t submaps_ = 0;
  std::function<void(const strata_msgs::msg::PatchMap&)> publish_map_;
};

}  // namespace strata::patch_learner
