// SPDX-License-Identifier: Apache-2.0
/// strata::BeamFilter: posed scans in; which of their beams hit static things out, by what was seen
/// so far.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "components/beam_filter/config.hpp"
#include "components/log/state_store.hpp"
#include "components/runtime/component.hpp"
#include "components/runtime/pose_watch.hpp"
#include "core/grid/counting_map.hpp"

namespace strata::beam_filter {

/// In: posed_scan. Out: scan_static, scan_dynamic (NaN for beams of the other class), labeled_scan,
/// map_filtered and, live, reflection_filtered. A scan's labels go out before anything else is
/// done. Memory: a window of scans, and the map. The labels over a whole log need the poses too and
/// come from the scan matcher's finish (docs/decisions/). Live it goes on from its store.
class BeamFilter final : public runtime::Component {
 public:
  using Component::Component;

 private:
  void on_declare() override { declare_parameters<BeamFilterComponentConfig>(); }
  void on_configure() override;
  void on_activate() override;
  void on_deactivate() override;
  void on_tick() override;
  void on_cleanup() override;
  void on_diagnose(runtime::Health& health) const override;
  [[nodiscard]] bool learns() const override { return true; }
  void open_store();
  void on_scan(PosedScan scan);
  void publish_classes(const PosedScan& scan);
  void publish_map(const ReflectionGrid& filtered, Stamp stamp);

  BeamFilterComponentConfig config_;
  std::optional<OnlineFilter> online_;
  std::optional<log::StateStore> store_;
  runtime::PoseWatch poses_;
  std::uint64_t scans_ = 0;
  std::function<void(const sensor_msgs::msg::LaserScan&)> publish_static_;
  std::function<void(const sensor_msgs::msg::LaserScan&)> publish_dynamic_;
  std::function<void(const strata_msgs::msg::LabeledScan&)> publish_labeled_;
  std::function<void(const nav_msgs::msg::OccupancyGrid&)> publish_map_;
  std::function<void(const strata_msgs::msg::ReflectionGrid&)> publish_reflection_;
};

}  // namespace strata::beam_filter
