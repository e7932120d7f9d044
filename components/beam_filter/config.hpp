// SPDX-License-Identifier: Apache-2.0
/// Parameters of strata::BeamFilter.
#pragma once

#include <string>

#include "core/beam_filter/online_filter.hpp"

namespace strata::beam_filter {

/// What a beam filter that was stopped goes on with.
struct FilterStoreConfig {
  std::string file;
  double period_s = 30.0;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("file", c.file,
            {.doc = "live: keep the map and the window in this file, and go on from it when it "
                    "exists; it belongs to the poses of the scan matcher's store; empty: in RAM "
                    "only"});
    v.field("period_s", c.period_s,
            {.doc = "written this often, by the stamps of the scans, and when the component is "
                    "deactivated; what a crash may lose at most",
             .unit = "s",
             .min = 0.0});
  }
};

struct BeamFilterComponentConfig {
  BeamFilterConfig filter;
  WindowConfig window;
  std::string map_frame = "map";
  int map_every_scans = 25;
  FilterStoreConfig store;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.group("filter", c.filter, "what makes a beam static");
    v.group("window", c.window, "which scans beams are judged by");
    v.field("map_frame", c.map_frame, {.doc = "frame of the maps out"});
    v.field("map_every_scans", c.map_every_scans,
            {.doc = "the filtered map is published anew after so many scans",
             .unit = "scans",
             .min = 1.0});
    v.group("store", c.store, "going on after the process was stopped");
  }
};

}  // namespace strata::beam_filter
