// SPDX-License-Identifier: Apache-2.0
#include "components/timescale_memory/timescale_memory.hpp"

#include <cmath>
#include <cstdlib>

#include "components/convert/scan_messages.hpp"
#include "components/maps/maps_folder.hpp"
#include "components/maps/node_map_message.hpp"

namespace strata::timescale_memory {

void TimescaleMemory::on_configure() {
  config_ = read_parameters<TimescaleMemoryConfig>();
  keep_live(config_, {"publish_period_s"});
  if (!lockstep() && !config_.store.empty()) {
    file_.emplace(config_.store, config_.save_period_s);
    memory_.emplace(file_->resume(config_.timescale, context().seed));
  } else {
    memory_.emplace(config_.timescale, context().seed);
  }
  publish_map_ = advertise<strata_msgs::msg::NodeMap>("node_map", "latched");
  for (const auto& level : config_.timescale.levels) {
    publish_level_.push_back(
        advertise<sensor_msgs::msg::LaserScan>("expected_scan/" + level.name, "default"));
  }
  subscribe<strata_msgs::msg::LabeledScan>(lockstep() ? "mapped_scan" : "labeled_scan", "lossless",
                                           [this](const auto& message) { on_scan(message); });
}

void TimescaleMemory::on_tick() {
  if (file_) file_->save(*memory_, false);
}

void TimescaleMemory::on_deactivate() {
  if (file_) file_->save(*memory_, true);
}

bool TimescaleMemory::is_time_to_publish(Stamp stamp) {
  if (lockstep() || config_.publish_period_s <= 0.0) return false;
  // Stamps may run backwards, as when a bag starts again.
  const bool is_due = !last_published_ ||
                      std::abs((stamp - *last_published_).seconds()) >= config_.publish_period_s;
  if (is_due) last_published_ = stamp;
  return is_due;
}

void TimescaleMemory::on_scan(const strata_msgs::msg::LabeledScan& message) {
  const PosedScan scan = convert::from_message(message);
  memory_->observe(scan);
  if (!is_time_to_publish(scan.scan.stamp)) return;
  publish_map(scan.scan.stamp);
  publish_expected(scan, message.scan().header().frame_id());
}

void TimescaleMemory::publish_map(Stamp stamp) {
  decoded_ = memory_->decode(config_.decoding, decoded_.get());
  publish_map_(maps::to_message(*memory_, *decoded_, stamp, config_.map_frame));
}

void TimescaleMemory::publish_expected(const PosedScan& scan, const std::string& frame) {
  std::vector<double> bearings_rad;
  for (std::size_t i = 0; i < scan.scan.size(); ++i) {
    bearings_rad.push_back(scan.scan.bearing_rad(i));
  }
  Scan expected = scan.scan;
  for (std::size_t level = 0; level < publish_level_.size(); ++level) {
    decoded_->expected_ranges_m(static_cast<int>(level), scan.map_from_laser(), bearings_rad,
                                expected.ranges_m);
    publish_level_[level](convert::to_message(expected, frame));
  }
}

void TimescaleMemory::on_finish(const std::filesystem::path& out_dir) {
  memory_->close_day();
  publish_map(Stamp());
  maps::write_timescale(out_dir, *memory_);
}

void TimescaleMemory::on_cleanup() {
  memory_.reset();
  decoded_.reset();
  last_published_.reset();
  file_.reset();
  publish_level_.clear();
}

}  // namespace strata::timescale_memory
