// SPDX-License-Identifier: Apache-2.0
/// strata::MapServer: a map file in, a latched map out.
#pragma once

#include <functional>

#include "components/map_server/config.hpp"
#include "components/runtime/component.hpp"
#include "core/grid/reflection_grid.hpp"

namespace strata::map_server {

class MapServer final : public runtime::Component {
 public:
  using Component::Component;

 private:
  void on_configure() override;
  void on_activate() override;

  MapServerConfig config_;
  ReflectionGrid map_;
  std::function<void(const nav_msgs::msg::OccupancyGrid&)> publish_;
};

}  // namespace strata::map_server
