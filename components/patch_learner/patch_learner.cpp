// SPDX-License-Identifier: Apache-2.0
#include "components/patch_learner/patch_learner.hpp"

#include "components/convert/geometry_messages.hpp"
#include "components/convert/map_messages.hpp"
#include "components/convert/patch_messages.hpp"
#include "components/convert/scan_messages.hpp"
#include "components/maps/maps_folder.hpp"

namespace strata::patch_learner {

void PatchLearner::on_configure() {
  config_ = read_parameters<PatchLearnerComponentConfig>();
  keep_live(config_, {"learn_every_scans"});
  learner_.emplace(config_.patch, context().threads);
  publish_map_ = advertise<strata_msgs::msg::PatchMap>("patch_map", "latched");
  subscribe<strata_msgs::msg::ReflectionGrid>(
      "reflection_filtered", "latched",
      [this](const auto& message) { filtered_ = convert::from_message(message); });
  subscribe<strata_msgs::msg::LabeledScan>(lockstep() ? "mapped_scan" : "labeled_scan", "lossless",
                                           [this](const auto& message) { on_scan(message); });
}

void PatchLearner::on_scan(const strata_msgs::msg::LabeledScan& message) {
  learner_->add(convert::from_message(message));
  const auto every = static_cast<std::size_t>(config_.learn_every_scans);
  if (lockstep() || every == 0 || learner_->size() % every != 0 || !filtered_) return;
  publish_map_(convert::to_message(learner_->finish(*filtered_, context().progress),
                                   convert::from_message(message.scan().header().stamp()),
                                   config_.map_frame));
}

void PatchLearner::on_finish(const std::filesystem::path& out_dir) {
  if (!filtered_) {
    throw InputError(full_name(), "no filtered map came",
                     "add a strata::ScanMatcher before it to the composition");
  }
  const patch::PatchMap map = learner_->finish(*filtered_, context().progress);
  publish_map_(convert::to_message(map, Stamp(), config_.map_frame));
  maps::write_patch_map(out_dir, map);
}

void PatchLearner::on_cleanup() {
  learner_.reset();
  filtered_.reset();
}

}  // namespace strata::patch_learner
