// SPDX-License-Identifier: Apache-2.0
/// strata::PatchLearner: posed scans and the filtered map in; the patch map out.
#pragma once

#include <functional>
#include <optional>

#include "components/patch_learner/config.hpp"
#include "components/runtime/component.hpp"
#include "core/patch/patch_learner.hpp"

namespace strata::patch_learner {

/// In: mapped_scan (lockstep) or labeled_scan (live), reflection_filtered. Out: patch_map; at the
/// end of a log the patch map in MAPS.
class PatchLearner final : public runtime::Component {
 public:
  using Component::Component;

 private:
  void on_configure() override;
  void on_cleanup() override;
  [[nodiscard]] bool learns() const override { return true; }
  void on_finish(const std::filesystem::path& out_dir) override;
  void on_scan(const strata_msgs::msg::LabeledScan& message);

  PatchLearnerComponentConfig config_;
  std::optional<patch::PatchLearner> learner_;
  std::optional<ReflectionGrid> filtered_;
  std::function<void(const strata_msgs::msg::PatchMap&)> publish_map_;
};

}  // namespace strata::patch_learner
