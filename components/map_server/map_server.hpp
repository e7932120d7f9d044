// SPDX-License-Identifier: Apache-2.0
/// strata::MapServer: a map file in, a latched map out; another file on request.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "components/map_server/config.hpp"
#include "components/runtime/component.hpp"
#include "core/grid/reflection_grid.hpp"

namespace strata::map_server {

/// Services, as nav2's map_server: ~/map gives the map, ~/load_map reads another file in its place
/// and publishes it (a path or file://; only while active). Without a map it says nothing, and
/// ~/map answers an empty grid.
class MapServer final : public runtime::Component {
 public:
  using Component::Component;

 private:
  void on_declare() override { declare_parameters<MapServerConfig>(); }
  void on_configure() override;
  void on_activate() override;
  [[nodiscard]] nav2_msgs::srv::LoadMap_Response load(const std::string& url);
  [[nodiscard]] nav_msgs::msg::OccupancyGrid message() const;

  MapServerConfig config_;
  std::optional<ReflectionGrid> map_;  ///< nothing until a file was read
  Stamp loaded_;
  std::function<void(const nav_msgs::msg::OccupancyGrid&)> publish_;
};

}  // namespace strata::map_server
