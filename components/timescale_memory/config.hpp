// SPDX-License-Identifier: Apache-2.0
/// Parameters of strata::TimescaleMemory.
#pragma once

#include <string>

#include "memory/decoding/decoding_config.hpp"
#include "memory/nodes/timescale_config.hpp"

namespace strata::timescale_memory {

struct TimescaleMemoryConfig {
  memory::TimescaleConfig timescale;
  memory::DecodingConfig decoding;
  std::string map_frame = "map";
  int publish_every_scans = 50;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.group("timescale", c.timescale, "the timescale memory");
    v.group("decoding", c.decoding, "how levels become expected scans");
    v.field("map_frame", c.map_frame, {.doc = "frame of the map out"});
    v.field("publish_every_scans", c.publish_every_scans,
            {.doc = "live: node_map and expected scans go out after so many; 0: never",
             .unit = "scans",
             .min = 0.0});
  }
};

}  // namespace strata::timescale_memory
