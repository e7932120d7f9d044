// SPDX-License-Identifier: Apache-2.0
/// Parameters of strata::MapSaver.
#pragma once

#include <string>

#include "core/base/config.hpp"

namespace strata::map_saver {

struct MapSaverConfig {
  std::string folder;
  std::string topic = "map";
  double save_map_timeout_s = 2.0;
  bool map_subscribe_transient_local = true;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("folder", c.folder,
            {.doc = "where maps go that are asked for by a name without a folder; empty: the "
                    "folder the process runs in",
             .when = "maps are saved by bare names, as nav2 asks for them"});
    v.field("topic", c.topic, {.doc = "saved when the request names no topic"});
    v.field("save_map_timeout_s", c.save_map_timeout_s,
            {.doc = "how long a request waits for a map", .unit = "s", .min = 0.0, .max = 60.0});
    v.field("map_subscribe_transient_local", c.map_subscribe_transient_local,
            {.doc = "take the map as it was published last; false: wait for the next one, of "
                    "publishers that do not latch theirs too"});
  }
};

}  // namespace strata::map_saver
