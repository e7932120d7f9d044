// SPDX-License-Identifier: Apache-2.0
/// Parameters of strata::BeamFilter.
#pragma once

#include <string>

#include "components/log/state_store.hpp"
#include "components/runtime/common_settings.hpp"
#include "core/beam_filter/online_filter.hpp"

namespace strata::beam_filter {

struct BeamFilterComponentConfig {
  BeamFilterConfig filter;
  WindowConfig window;
  NoReturnConfig no_return;
  std::string map_frame = "map";
  int map_every_scans = 0;
  log::StateStoreConfig store;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.group("filter", c.filter, "what makes a beam static");
    v.group("window", c.window, "which scans beams are judged by");
    v.group("no_return", c.no_return, "what beams without return say");
    v.field("map_frame", c.map_frame, runtime::kMapFrame);
    v.field(
        "map_every_scans", c.map_every_scans,
        {.doc = "the filtered map is published anew after so many scans; 0: never, where a scan "
                "matcher publishes its own, which loop closures mend",
         .unit = "scans",
         .min = 0.0});
    v.group("store", c.store,
            "going on after the process was stopped; the file belongs to the poses of the scan "
            "matcher's store");
  }
};

}  // namespace strata::beam_filter
