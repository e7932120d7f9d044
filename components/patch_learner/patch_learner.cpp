// SPDX-License-Identifier: Apache-2.0
#include "components/patch_learner/patch_learner.hpp"

#include <cmath>
#include <cstring>
#include <utility>

#include "components/convert/geometry_messages.hpp"
#include "components/convert/map_messages.hpp"
#include "components/convert/patch_messages.hpp"
#include "components/convert/scan_messages.hpp"
#include "components/maps/earlier_runs.hpp"
#include "components/maps/maps_folder.hpp"

namespace strata::patch_learner {
namespace {

/// Bit by bit: unknown cells are NaN.
bool is_same(const ReflectionGrid& a, const ReflectionGrid& b) {
  return a.rect() == b.rect() &&
         std::memcmp(a.values().data(), b.values().data(), a.size() * sizeof(float)) == 0;
}

}  // namespace

void PatchLearner::on_configure() {
  config_ = read_parameters<PatchLearnerComponentConfig>();
  keep_live(config_, {"learn_every_scans"});
  learner_.emplace(config_.patch, context().threads);
  publish_map_ = advertise<strata_msgs::msg::PatchMap>("patch_map", "latched");
  subscribe<strata_msgs::msg::ReflectionGrid>(
      "reflection_filtered", "latched",
      [this](const auto& message) { on_base(convert::from_message(message)); });
  const auto take = [this](const auto& message) { on_scan(message); };
  const OnlineLearningConfig& online = config_.online;
  if (online.enabled && !online.maps.empty()) on_base(maps::read_maps(online.maps).filtered);
  if (lockstep() && (!online.enabled || online.maps.empty())) {
    subscribe<strata_msgs::msg::LabeledScan>("mapped_scan", "lossless", take);
  }
  if (online.enabled || !lockstep()) {
    subscribe<strata_msgs::msg::LabeledScan>(online.enabled ? online.scan_topic : "labeled_scan",
                                             "lossless", take);
  }
}

void PatchLearner::on_base(ReflectionGrid filtered) {
  filtered_ = std::move(filtered);
  if (!config_.online.enabled) return;
  if (online_) {
    online_->set_base(*filtered_);
  } else {
    begin_online(*filtered_);
  }
}

void PatchLearner::begin_online(const ReflectionGrid& base) {
  const OnlineLearningConfig& online = config_.online;
  online_.emplace(config_.patch, online.learner, base, context().threads);
  const bool keeps = !lockstep() && !online.store.folder.empty() && !context().only_explained;
  if (keeps) store_.emplace(online.store.folder, online.store.state_period_s);
  if (!restore(base) && !online.maps.empty()) {
    maps::EarlierRuns earlier = maps::read_earlier_runs(online.maps);
    first_run_ = earlier.next_run;
    for (PosedScan& scan : earlier.scans) (void)online_->add(std::move(scan));
  }
  if (store_) store_->begin(*online_);
  submaps_ = online_->map().submaps.size();
}

bool PatchLearner::restore(const ReflectionGrid& base) {
  if (!store_ || !store_->has_state()) return false;
  first_run_ = store_->restore(*online_) + 1;
  has_news_ = true;
  const ReflectionGrid& stored = online_->base();
  if (config_.online.maps.empty()) {
    online_->set_base(base);
  } else if (!is_same(stored, base)) {
    throw ConfigError(full_name(),
                      "online.store.folder '" + config_.online.store.folder +
                          "' was learned on other maps than '" + config_.online.maps + "'",
                      "name the maps it belongs to, or another folder");
  }
  return true;
}

void PatchLearner::on_scan(const strata_msgs::msg::LabeledScan& message) {
  PosedScan scan = convert::from_message(message);
  if (!lockstep()) poses_.require(scan.map_from_robot, resolve("labeled_scan"));
  if (config_.online.enabled) {
    learn_online(std::move(scan));
    return;
  }
  learner_->add(std::move(scan));
  const auto every = static_cast<std::size_t>(config_.learn_every_scans);
  if (lockstep() || every == 0 || learner_->size() % every != 0 || !filtered_) return;
  publish_map_(convert::to_message(learner_->finish(*filtered_, context().progress),
                                   convert::from_message(message.scan().header().stamp()),
                                   config_.map_frame));
}

void PatchLearner::learn_online(PosedScan scan) {
  if (!online_) {
    ++scans_without_map_;
    return;
  }
  const Stamp now = scan.scan.stamp;
  scan.run += first_run_;
  if (store_) {
    has_news_ = online_->add(scan) || has_news_;
    guarded([&] { store_->add(*online_, scan); });  // learning and publishing go on
  } else {
    has_news_ = online_->add(std::move(scan)) || has_news_;
  }
  if (!has_news_) return;
  if (published_ && std::abs((now - *published_).seconds()) < config_.online.publish_every_s) {
    return;
  }
  const patch::PatchMap map = online_->map();
  submaps_ = map.submaps.size();
  publish_map_(convert::to_message(map, now, config_.map_frame));
  published_ = now;
  has_news_ = false;
}

void PatchLearner::on_diagnose(runtime::Health& health) const {
  if (!config_.online.enabled) {
    health.add("scans", static_cast<std::uint64_t>(learner_ ? learner_->size() : 0));
    return;
  }
  if (!online_) {
    health.warn("no map to learn on has come yet");
    health.add("scans without a map", scans_without_map_);
    return;
  }
  const patch::OnlineStatus& status = online_->status();
  if (status.is_over_budget)
    health.warn("the mapped area alone needs more than online.learner.memory_mb");
  health.add("scans", static_cast<std::uint64_t>(status.scans_seen));
  health.add("scans kept", static_cast<std::uint64_t>(status.scans));
  health.add("sub-maps", static_cast<std::uint64_t>(submaps_));
  health.add("sequences kept", static_cast<std::uint64_t>(status.sequences));
  health.add("configurations forgotten",
             static_cast<std::uint64_t>(status.forgotten_configurations));
  health.add("bytes", static_cast<std::uint64_t>(status.bytes));
}

void PatchLearner::on_finish(const std::filesystem::path& out_dir) {
  if (!filtered_) {
    throw InputError(full_name(), "no filtered map came",
                     "add a strata::ScanMatcher before it to the composition");
  }
  const patch::PatchMap map =
      online_ ? online_->finish() : learner_->finish(*filtered_, context().progress);
  publish_map_(convert::to_message(map, Stamp(), config_.map_frame));
  maps::write_patch_map(out_dir, map);
}

void PatchLearner::on_tick() {
  const std::chrono::duration<double> since = std::chrono::steady_clock::now() - flushed_;
  if (!store_ || since.count() < config_.online.store.save_period_s) return;
  flushed_ = std::chrono::steady_clock::now();
  store_->flush();
}

void PatchLearner::on_deactivate() {
  if (store_) store_->flush();
}

void PatchLearner::on_cleanup() {
  store_.reset();
  learner_.reset();
  filtered_.reset();
  online_.reset();
  poses_ = {};
  published_.reset();
  has_news_ = false;
  scans_without_map_ = 0;
}

}  // namespace strata::patch_learner
