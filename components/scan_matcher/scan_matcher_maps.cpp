// SPDX-License-Identifier: Apache-2.0
// What others get of the map while the robot is mapping: topics and a folder.
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <string>
#include <utility>

#include "components/convert/patch_messages.hpp"
#include "components/log/writable_place.hpp"
#include "components/maps/earlier_runs.hpp"
#include "components/maps/maps_folder.hpp"
#include "components/runtime/share_of_time.hpp"
#include "components/scan_matcher/damaged_maps.hpp"
#include "components/scan_matcher/scan_matcher.hpp"
#include "core/base/error.hpp"

namespace strata::scan_matcher {

void ScanMatcher::open_live_maps() {
  publisher_.emplace(
      config_.maps.publish_every_s, config_.slam.beam_filter, config_.map_frame,
      MapPublisher::Topics{
          publish_map_, advertise<nav_msgs::msg::OccupancyGrid>("map_filtered", "latched"),
          publish_filtered_, advertise<nav_msgs::msg::Path>("trajectory", "latched")});
  offer_later<bus::srv::Trigger>("~/save", [this](const auto&, auto reply) {
    const std::string folder = saver_ ? saver_->folder().string() : "";
    save_maps([folder, reply](const std::string& error) {
      std_srvs::srv::Trigger_Response response;
      response.success(error.empty());
      response.message(error.empty() ? "saved in " + folder : error);
      reply(response);
    });
  });
  if (config_.maps.folder.empty()) return;
  subscribe<strata_msgs::msg::PatchMap>(config_.maps.patch_topic, "latched",
                                        [this](const auto& message) { take_patches(message); });
  const auto damage = damage_of_live_maps(config_.maps.folder);
  if (context().dry_run) {
    if (!damage) require_replaceable(config_.maps.folder);
    return log::require_folder_place(config_.maps.folder);
  }
  if (damage) {
    (void)restored(config_.maps.folder, [&] { throw *damage; });
  }
  saver_.emplace(config_.maps.folder, SaverConfig{config_.slam, config_.live, config_.maps.patch});
  saved_ = std::chrono::steady_clock::now();
}

/// A learner that has just begun knows of no changes: that is no reason to forget them.
void ScanMatcher::take_patches(const strata_msgs::msg::PatchMap& message) {
  if (message.submaps().empty() && patches_ && !patches_->submaps().empty()) return;
  patches_ = message;
  has_new_patches_ = true;
}

std::size_t ScanMatcher::newest_mapped() const {
  std::size_t newest = 0;
  slam_->visit_mapped([&](const auto& mapped) { newest = mapped.number + 1; });
  return newest;
}

bool ScanMatcher::has_unsaved() const {
  return has_new_patches_ || newest_mapped() > saved_mapped_;
}

void ScanMatcher::go_on_from_folder() {
  const std::filesystem::path folder = saver_->folder();
  const bool is_new = !slam_->newest();
  maps::EarlierRuns earlier;
  std::optional<patch::PatchMap> patches;
  const bool is_whole = restored(folder, [&] {
    if (is_new) earlier = maps::read_earlier_runs(folder);
    patches = maps::read_maps(folder).patches;
  });
  if (!is_whole) return;
  if (patches) patches_ = convert::to_message(*patches, Stamp(), config_.map_frame);
  for (const PosedScan& scan : earlier.scans) slam_->add_placed(scan);
  is_restored_ = slam_->newest().has_value();
}

void ScanMatcher::save_maps(MapsSaver::Done done) {
  if (!saver_ || !slam_->newest()) {
    if (done) done(saver_ ? "no scan has come yet" : "no folder is named: set maps.folder");
    return;
  }
  saved_mapped_ = newest_mapped();
  has_new_patches_ = false;
  saved_ = std::chrono::steady_clock::now();
  saver_->save({slam_->save_state(), patches_}, std::move(done));
}

void ScanMatcher::save_maps_now_and_then() {
  if (!saver_ || config_.maps.save_every_s <= 0.0 || saver_->is_busy()) return;
  const std::chrono::duration<double> since = std::chrono::steady_clock::now() - saved_;
  if (since.count() < std::max(config_.maps.save_every_s, runtime::rest_after_s(saver_->last_s())))
    return;
  if (has_unsaved()) save_maps({});
}

/// What could not be saved is to be saved.
void ScanMatcher::check_saver() {
  try {
    saver_->check();
  } catch (const OutputError&) {
    saved_mapped_ = 0;
    throw;
  }
}

void ScanMatcher::publish_maps() {
  if (!publisher_ || !slam_->newest()) return;
  publisher_->update(*slam_, slam_->newest()->stamp);
}

}  // namespace strata::scan_matcher
