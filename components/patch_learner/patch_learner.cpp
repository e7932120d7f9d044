// SPDX-License-Identifier: Apache-2.0
#include "components/patch_learner/patch_learner.hpp"

#include <cmath>
#include <cstring>
#include <utility>

#include "components/convert/geometry_messages.hpp"
#include "components/convert/map_messages.hpp"
#include "components/convert/patch_messages.hpp"
#include "components/convert/scan_messages.hpp"
#include "components/log/damaged_file.hpp"
#include "components/log/stored_bytes.hpp"
#include "components/maps/earlier_runs.hpp"
#include "components/maps/maps_folder.hpp"
#include "components/runtime/share_of_time.hpp"
#include "core/grid/blind_beams.hpp"
#include "core/grid/shared_walls.hpp"
#include "core/patch/without_change.hpp"

namespace strata::patch_learner {
namespace {

/// Bit by bit: unknown cells are NaN.
bool is_same(const ReflectionGrid& a, const ReflectionGrid& b) {
  return a.rect() == b.rect() &&
         std::memcmp(a.values().data(), b.values().data(), a.size() * sizeof(float)) == 0;
}

/// Less of the walls that were learned on are not gone, but in another frame.
constexpr double kMinShared = 0.5;

/// Scans that wait for the first map.
constexpr std::size_t kMaxEarly = 200;

}  // namespace

void PatchLearner::on_configure() {
  config_ = read_parameters<PatchLearnerComponentConfig>();
  keep_live(config_, {"learn_every_scans"});
  learner_.emplace(config_.patch, context().threads);
  zones_ = config_.zones.empty() ? site::no_zones() : site::zones_at(config_.zones);
  publish_map_ = advertise<strata_msgs::msg::PatchMap>("patch_map", "latched");
  const OnlineLearningConfig& online = config_.online;
  is_online_ = online.enabled && (!lockstep() || !online.maps.empty());
  subscribe<strata_msgs::msg::ReflectionGrid>(
      "reflection_filtered", "latched",
      [this](const auto& message) { on_base(convert::from_message(message)); });
  if (is_online_ && !online.maps.empty()) on_base(maps::read_maps(online.maps).filtered);
  if (!lockstep() && is_online_ && !online.trajectory_topic.empty()) {
    subscribe<nav_msgs::msg::Path>(online.trajectory_topic, "latched",
                                   [this](const auto& message) { on_trajectory(message); });
  }
  const bool learns_at_end = lockstep() && !is_online_;
  const std::string live_topic = is_online_ ? online.scan_topic : "labeled_scan";
  subscribe<strata_msgs::msg::LabeledScan>(learns_at_end ? "mapped_scan" : live_topic, "lossless",
                                           [this](const auto& message) { on_scan(message); });
}

void PatchLearner::on_base(ReflectionGrid filtered) {
  const bool is_new = !filtered_ || !is_same(*filtered_, filtered);
  filtered_ = std::move(filtered);
  if (is_new) limits_ = site::learn_limits(zones_, filtered_->resolution_m());
  if (!is_online_ || !is_new) return;
  if (online_) {
    online_->set_base(*filtered_);
    has_news_ = true;
    publish_if_due();
    return;
  }
  has_news_ = config_.online.maps.empty();  // others have those maps
  try {
    begin_online(*filtered_);
  } catch (...) {  // half of it must neither learn nor be written
    online_.reset();
    relearner_.reset();
    store_.reset();
    throw;
  }
}

void PatchLearner::make_online(const ReflectionGrid& base) {
  online_ = std::make_unique<patch::OnlinePatchLearner>(config_.patch, config_.online.learner, base,
                                                        context().threads);
}

void PatchLearner::begin_online(const ReflectionGrid& base) {
  const OnlineLearningConfig& online = config_.online;
  make_online(base);
  relearner_.emplace(config_.patch, online.learner, context().threads);
  const bool keeps = !lockstep() && !online.store.folder.empty() && !context().dry_run;
  if (keeps) store_.emplace(online.store.folder, online.store.state_period_s);
  bool is_stored = store_ && store_->has_state();
  bool is_restored = is_stored && restore(base);
  if (is_restored && online.maps.empty() && shared_walls(online_->base(), base) < kMinShared) {
    set_other_map_aside(base);
    is_stored = is_restored = false;
  }
  if (!is_restored && !online.maps.empty()) {
    maps::EarlierRuns earlier = maps::read_earlier_runs(online.maps);
    first_run_ = earlier.next_run;
    for (PosedScan& scan : earlier.scans) (void)online_->add(std::move(scan));
  }
  if (is_stored) add_stored_scans(is_restored);
  if (is_restored && online.maps.empty()) online_->set_base(base);
  if (store_) guarded([this] { store_->begin(*online_); });  // tried again with the next state
  count_areas(online_->map());
  for (PosedScan& scan : std::exchange(early_, {})) learn_online(std::move(scan));
}

bool PatchLearner::restore(const ReflectionGrid& base) {
  if (!restored(store_->state_file(), [&] { store_->restore_state(*online_); })) {
    make_online(base);
    return false;
  }
  if (!config_.online.maps.empty() && !is_same(online_->base(), base)) {
    throw ConfigError(full_name(),
                      "online.store.folder '" + config_.online.store.folder +
                          "' was learned on other maps than '" + config_.online.maps + "'",
                      "name the maps it belongs to, or another folder");
  }
  return true;
}

void PatchLearner::set_other_map_aside(const ReflectionGrid& base) {
  const std::string state = store_->state_file().string();
  for (const auto& file : store_->scans_files(nullptr)) (void)log::set_aside(file);
  const std::string aside = log::set_aside(state).string();
  warn(InputError(state,
                  "was learned on a map that has few walls where the one that comes has them; it "
                  "was set aside as '" +
                      aside + "', and is gone on without",
                  "keep the stores of a scan matcher and of who learns in its map together"));
  make_online(base);
}

void PatchLearner::add_stored_scans(bool is_restored) {
  for (const auto& file : store_->scans_files(is_restored ? &*online_ : nullptr)) {
    (void)restored(file, [&] { (void)LearnerStore::add_scans(file, *online_); });
  }
  if (online_->status().scans_seen > 0) first_run_ = online_->last_run() + 1;
  has_news_ = true;
}

void PatchLearner::on_scan(const strata_msgs::msg::LabeledScan& message) {
  PosedScan scan = convert::from_message(message);
  if (!lockstep()) poses_.require(scan.map_from_robot, resolve("labeled_scan"));
  if (is_online_) {
    learn_online(std::move(scan));
    return;
  }
  if (filtered_) (void)blind_beams(scan, limits_.never);
  learner_->add(std::move(scan));
  const auto every = static_cast<std::size_t>(config_.learn_every_scans);
  if (lockstep() || every == 0 || learner_->size() % every != 0 || !filtered_) return;
  patch::PatchMap map = learner_->finish(*filtered_, context().progress);
  patch::keep_static(map, limits_.static_only);
  publish_map_(convert::to_message(map, convert::from_message(message.scan().header().stamp()),
                                   config_.map_frame));
}

void PatchLearner::learn_online(PosedScan scan) {
  if (!online_) {
    early_.push_back(std::move(scan));
    if (early_.size() <= kMaxEarly) return;
    early_.pop_front();
    ++scans_without_map_;
    return;
  }
  (void)blind_beams(scan, limits_.never);
  // By a clock that was set back no visit would end before it has caught up: another run begins.
  newest_ = scan.scan.stamp;
  if (!lockstep() && clock_.add(*newest_) == log::SetBackWatch::Verdict::kSetBack) ++first_run_;
  scan.run += first_run_;
  if (store_) {
    has_news_ = online_->add(scan) || has_news_;
    guarded([&] { store_->add(*online_, scan); });  // learning and publishing go on
  } else {
    has_news_ = online_->add(std::move(scan)) || has_news_;
  }
  publish_if_due();
}

void PatchLearner::publish_if_due() {
  const Clock::time_point begin = Clock::now();
  if (!has_news_ || (!lockstep() && begin < may_publish_)) return;
  if (published_ && std::abs((*newest_ - *published_).seconds()) < config_.online.publish_every_s) {
    return;
  }
  patch::PatchMap map = online_->map();
  patch::keep_static(map, limits_.static_only);
  count_areas(map);
  publish_map_(convert::to_message(map, newest_.value_or(Stamp()), config_.map_frame));
  published_ = newest_;
  has_news_ = false;
  may_publish_ = runtime::next_turn(begin);
}

void PatchLearner::count_areas(const patch::PatchMap& map) {
  submaps_ = map.submaps.size();
  unrecurring_ = map.unrecurring.size();
}

void PatchLearner::on_diagnose(runtime::Health& health) const {
  if (!is_online_) {
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
  health.add("areas left out, where nothing returns", static_cast<std::uint64_t>(unrecurring_));
  health.add("sequences kept", static_cast<std::uint64_t>(status.sequences));
  health.add("configurations forgotten",
             static_cast<std::uint64_t>(status.forgotten_configurations));
  health.add("bytes", static_cast<std::uint64_t>(status.bytes));
  health.add("times that loop closures moved scans", moves_);
  if (store_)
    health.add_later("store_bytes",
                     [this] { return log::stored_bytes(config_.online.store.folder); });
  if (relearner_ && relearner_->is_busy()) health.add("learns again", "from scans that moved");
}

void PatchLearner::on_finish(const std::filesystem::path& out_dir) {
  if (!filtered_) {
    throw InputError(full_name(), "no filtered map came",
                     "add a strata::ScanMatcher before it to the composition");
  }
  patch::PatchMap map =
      online_ ? online_->finish() : learner_->finish(*filtered_, context().progress);
  patch::keep_static(map, limits_.static_only);
  publish_map_(convert::to_message(map, Stamp(), config_.map_frame));
  maps::write_patch_map(out_dir, map);
}

void PatchLearner::on_tick() {
  if (online_) {
    guarded([this] { move_scans(); });
    publish_if_due();
  }
  const std::chrono::duration<double> since = std::chrono::steady_clock::now() - flushed_;
  if (!store_ || since.count() < config_.online.store.save_period_s) return;
  flushed_ = std::chrono::steady_clock::now();
  store_->flush();
}

void PatchLearner::on_deactivate() {
  if (store_) store_->finish(*online_);
}

void PatchLearner::on_cleanup() {
  store_.reset();
  learner_.reset();
  filtered_.reset();
  relearner_.reset();
  online_.reset();
  poses_ = {};
  published_.reset();
  known_poses_.reset();
  has_known_poses_ = false;
  early_.clear();
  may_move_ = {};
  may_publish_ = {};
  has_news_ = false;
  scans_without_map_ = 0;
  moves_ = 0;
  first_run_ = 0;
  newest_.reset();
  clock_ = {};
}

}  // namespace strata::patch_learner
