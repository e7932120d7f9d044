// SPDX-License-Identifier: Apache-2.0
#include "components/timescale_memory/timescale_memory.hpp"

#include "components/convert/scan_messages.hpp"
#include "components/maps/maps_folder.hpp"
#include "components/maps/node_map_message.hpp"

namespace strata::timescale_memory {

void TimescaleMemory::on_configure() {
  config_ = read_parameters<TimescaleMemoryConfig>();
  memory_.emplace(config_.timescale, context().seed);
  publish_map_ = advertise<strata_msgs::msg::NodeMap>("node_map", "latched");
  for (const auto& level : config_.timescale.levels) {
    publish_level_.push_back(
        advertise<sensor_msgs::msg::LaserScan>("expected_scan/" + level.name, "default"));
  }
  subscribe<strata_msgs::msg::LabeledScan>(lockstep() ? "mapped_scan" : "labeled_scan", "lossless",
                                           [this](const auto& message) { on_scan(message); });
}

void TimescaleMemory::on_scan(const strata_msgs::msg::LabeledScan& message) {
  const PosedScan scan = convert::from_message(message);
  const memory::Observed observed = memory_->observe(scan);
  const auto every = static_cast<std::uint64_t>(config_.publish_every_scans);
  if (!lockstep() && every > 0 && ++scans_ % every == 0) publish(scan.scan.stamp, observed.node);
}

void TimescaleMemory::publish(Stamp stamp, int node) {
  decoded_ = memory_->decode(config_.decoding, decoded_.get());
  publish_map_(maps::to_message(*memory_, *decoded_, stamp, config_.map_frame));
  if (node < 0) return;
  for (std::size_t level = 0; level < publish_level_.size(); ++level) {
    Scan scan = decoded_->expected_scan(static_cast<int>(level), node);
    scan.stamp = stamp;
    publish_level_[level](convert::to_message(scan, "node_" + std::to_string(node)));
  }
}

void TimescaleMemory::on_finish(const std::filesystem::path& out_dir) {
  publish(Stamp(), -1);
  maps::write_timescale(out_dir, *memory_);
}

}  // namespace strata::timescale_memory
