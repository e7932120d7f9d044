// SPDX-License-Identifier: Apache-2.0
/// Parameters of strata::TimescaleMemory.
#pragma once

#include <string>
#include <vector>

#include "components/runtime/common_settings.hpp"
#include "memory/decoding/decoding_config.hpp"
#include "memory/nodes/timescale_config.hpp"

namespace strata::timescale_memory {

struct TimescaleMemoryConfig {
  memory::TimescaleConfig timescale;
  memory::DecodingConfig decoding;
  std::string map_frame = "map";
  double publish_period_s = 1.0;
  std::string store;
  double save_period_s = 0.5;
  int resident_nodes = 500;
  double changes_period_s = 60.0;
  std::string changes_before;
  std::string changes_now;
  std::vector<std::string> robots;
  std::string zones;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.group("timescale", c.timescale, "the timescale memory");
    v.group("decoding", c.decoding, "how levels become expected scans");
    v.field("map_frame", c.map_frame, runtime::kMapFrame);
    v.field(
        "publish_period_s", c.publish_period_s,
        {.doc = "live: node_map and expected scans go out at most this often; levels are decoded "
                "then, and only where they have changed; 0: never",
         .unit = "s",
         .min = 0.0});
    v.field("store", c.store,
            {.doc = "live: keep the memory in this strata.db while the robot runs, and go on with "
                    "what it holds; empty: in RAM only",
             .when = "the memory shall outlive the process"});
    v.field("save_period_s", c.save_period_s,
            {.doc = "live: what a crash may lose at most", .unit = "s", .min = 0.0, .max = 60.0});
    v.field(
        "resident_nodes", c.resident_nodes,
        {.doc = "with a store: levels of this many nodes stay in RAM (about 160 kB each), those "
                "needed last; others are read again when the robot comes back",
         .min = 1});
    v.field("changes_period_s", c.changes_period_s,
            {.doc = "live: changed_places goes out at most this often, and only with node_map; it "
                    "takes about 2 ms a node; 0: never",
             .unit = "s",
             .min = 0.0});
    v.field("changes_before", c.changes_before,
            {.doc = "level that changed_places takes for the old state; empty: the last one"});
    v.field("changes_now", c.changes_now,
            {.doc = "level that it takes for the new state; empty: the first one"});
    v.field("robots", c.robots,
            {.doc = "live: namespaces of the robots that feed this memory, such as [/robot1, "
                    "/robot2], all in one map frame and with one clock; empty: the one in this "
                    "namespace",
             .when = "several robots share one memory"});
    v.field(
        "zones", c.zones,
        {.doc = "a site, or a GeoJSON file: beams that reach a zone of kind learn whose control "
                "is never_learn teach nothing; read when it is configured; empty: none"});
  }
};

}  // namespace strata::timescale_memory
