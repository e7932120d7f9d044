// SPDX-License-Identifier: Apache-2.0
#include "components/beam_filter/beam_filter.hpp"

#include <limits>

#include "components/convert/map_messages.hpp"
#include "components/convert/scan_messages.hpp"
#include "components/log/kept_file.hpp"
#include "components/log/stored_bytes.hpp"

namespace strata::beam_filter {

void BeamFilter::on_configure() {
  config_ = read_parameters<BeamFilterComponentConfig>();
  keep_live(config_, {"map_every_scans"});
  online_.emplace(config_.filter, config_.window, config_.no_return);
  publish_static_ = advertise<sensor_msgs::msg::LaserScan>("scan_static", "sensor_data");
  publish_dynamic_ = advertise<sensor_msgs::msg::LaserScan>("scan_dynamic", "sensor_data");
  publish_labeled_ = advertise<strata_msgs::msg::LabeledScan>("labeled_scan", "default");
  publish_map_ = advertise<nav_msgs::msg::OccupancyGrid>("map_filtered", "latched");
  subscribe<strata_msgs::msg::LabeledScan>("posed_scan", "default", [this](const auto& message) {
    on_scan(convert::from_message(message));
  });
  if (lockstep()) {
    subscribe<strata_msgs::msg::ReflectionGrid>(
        "reflection_filtered", "latched",
        [this](const auto& message) { publish_map(convert::from_message(message), Stamp()); });
  } else {
    publish_reflection_ =
        advertise<strata_msgs::msg::ReflectionGrid>("reflection_filtered", "latched");
    open_store();
  }
}

void BeamFilter::open_store() {
  if (config_.store.file.empty()) return;
  log::require_own_file(config_.store.file, log::kStateOfBeamFilter, "store.file");
  if (context().dry_run) return;
  store_.emplace(config_.store);
  const bool is_whole = restored(store_->file(), [&] {
    if (const auto state = store_->load()) online_->restore_state(*state, store_->file());
  });
  if (!is_whole) online_.emplace(config_.filter, config_.window, config_.no_return);
}

void BeamFilter::on_activate() {
  if (config_.map_every_scans == 0 || online_->scans_in_window() == 0) return;
  publish_map(online_->map(), online_->newest());
}

void BeamFilter::on_tick() {
  if (store_) store_->check();
}

void BeamFilter::on_deactivate() {
  if (!store_ || online_->scans_in_window() == 0) return;
  store_->write(online_->save_state());
  store_->flush();
}

void BeamFilter::on_scan(PosedScan scan) {
  if (!lockstep()) poses_.require(scan.map_from_robot, resolve("posed_scan"));
  scan.static_probability = online_->add(scan);
  publish_classes(scan);
  publish_labeled_(convert::to_message(scan, config_.map_frame, "laser"));
  const auto every = static_cast<std::uint64_t>(config_.map_every_scans);
  if (every > 0 && scans_ % every == 0) publish_map(online_->map(), scan.scan.stamp);
  ++scans_;
  if (store_ && store_->is_due(scan.scan.stamp)) store_->write(online_->save_state());
}

void BeamFilter::publish_classes(const PosedScan& scan) {
  sensor_msgs::msg::LaserScan classes[2] = {convert::to_message(scan.scan, "laser"),
                                            convert::to_message(scan.scan, "laser")};
  for (std::size_t beam = 0; beam < scan.scan.size(); ++beam) {
    if (scan.scan.kind(beam) != BeamKind::kHit) continue;
    const std::size_t other = is_dynamic(scan.static_probability[beam]) ? 0 : 1;
    classes[other].ranges()[beam] = std::numeric_limits<float>::quiet_NaN();
  }
  publish_static_(classes[0]);
  publish_dynamic_(classes[1]);
}

void BeamFilter::publish_map(const ReflectionGrid& filtered, Stamp stamp) {
  publish_map_(convert::to_occupancy(filtered, stamp, config_.map_frame));
  if (publish_reflection_) publish_reflection_(convert::to_message(filtered));
}

void BeamFilter::on_diagnose(runtime::Health& health) const {
  health.add("scans", scans_);
  health.add("scans in window", static_cast<std::uint64_t>(online_->scans_in_window()));
  health.add("cells of the map", static_cast<std::uint64_t>(online_->counts().cells().size()));
  if (store_) health.add_later("store_bytes", [this] { return log::stored_bytes(store_->file()); });
}

void BeamFilter::on_cleanup() {
  store_.reset();
  online_.reset();
  poses_ = {};
  scans_ = 0;
}

}  // namespace strata::beam_filter
