// SPDX-License-Identifier: Apache-2.0
/// Parameters of strata::MapServer.
#pragma once

#include <string>

#include "components/runtime/common_settings.hpp"
#include "core/base/config.hpp"

namespace strata::map_server {

struct MapServerConfig {
  std::string map;
  std::string topic = "map";
  std::string map_frame = "map";
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("map", c.map,
            {.doc = "the YAML file of a map_server map; empty: none until ~/load_map names one",
             .when = "always, but where who loads maps names them"});
    v.field("topic", c.topic, {.doc = "nav_msgs/OccupancyGrid out, latched"});
    v.field("map_frame", c.map_frame, runtime::kMapFrame);
  }
};

}  // namespace strata::map_server
