// SPDX-License-Identifier: Apache-2.0
/// strata::TimescaleMemory: posed scans in; what each level expects around each node out.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "components/runtime/component.hpp"
#include "components/timescale_memory/config.hpp"
#include "memory/nodes/timescale_memory.hpp"

namespace strata::timescale_memory {

/// In: mapped_scan (lockstep) or labeled_scan (live). Out: node_map, expected_scan/LEVEL of the
/// node the robot is at; at the end of a log the memory in MAPS.
class TimescaleMemory final : public runtime::Component {
 public:
  using Component::Component;

 private:
  void on_configure() override;
  [[nodiscard]] bool learns() const override { return true; }
  void on_finish(const std::filesystem::path& out_dir) override;
  void on_scan(const strata_msgs::msg::LabeledScan& message);
  void publish(Stamp stamp, int node);

  TimescaleMemoryConfig config_;
  std::optional<memory::TimescaleMemory> memory_;
  std::shared_ptr<const memory::NodeMap> decoded_;
  std::uint64_t scans_ = 0;
  std::function<void(const strata_msgs::msg::NodeMap&)> publish_map_;
  std::vector<std::function<void(const sensor_msgs::msg::LaserScan&)>> publish_level_;
};

}  // namespace strata::timescale_memory
