// SPDX-License-Identifier: Apache-2.0
/// strata::MapSaver: any map topic into files of map_server, on request.
#pragma once

#include <optional>
#include <string>

#include "components/map_saver/config.hpp"
#include "components/runtime/component.hpp"

namespace strata::map_saver {

/// Service ~/save_map, as nav2's map_saver: waits for the map on map_topic and writes map_url.yaml
/// and map_url.pgm or .png. The map is taken as it was published last, so the topic must be
/// latched; without map_subscribe_transient_local as it is published next. Image formats: pgm, png;
/// modes: trinary, scale (as png only), raw; left empty, pgm and trinary, and png for scale. The
/// thresholds asked for stand in the file; 0 are nav2's, 0.25 and 0.65.
class MapSaver final : public runtime::Component {
 public:
  using Component::Component;

 private:
  void on_declare() override { declare_parameters<MapSaverConfig>(); }
  void on_configure() override;
  /// Throws InputError and OutputError.
  void save(const nav2_msgs::srv::SaveMap_Request& request) const;
  [[nodiscard]] std::optional<nav_msgs::msg::OccupancyGrid> wait_for_map(
      const std::string& topic) const;

  MapSaverConfig config_;
};

}  // namespace strata::map_saver
