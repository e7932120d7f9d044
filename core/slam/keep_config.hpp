// SPDX-License-Identifier: Apache-2.0
/// What a robot that maps for days keeps of its past.
#pragma once

#include "core/base/config.hpp"

namespace strata::slam {

/// With a window, memory is bounded by the window and the map: of scans before the window only
/// those that entered a local map stay, and a local map stays only while it is among the latest
/// `views` that saw some `own_share` of what it holds. So where each cell of the map has been seen,
/// the local maps that are kept cover views / own_share times the map's area at most. A run that
/// ended without a place in the map, and that nothing is searched in any more, goes as a whole with
/// the window.
struct KeepConfig {
  int window_scans = 0;
  int views = 3;
  double own_share = 0.1;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("window_scans", c.window_scans,
            {.doc = "the latest scans, all of which are kept; 0: every scan and local map is kept",
             .unit = "scans",
             .min = 0.0,
             .when = "a robot that maps for hours needs too much memory (lower it), or loops close "
                     "late (raise it)"});
    v.field(
        "views", c.views,
        {.doc = "a local map is forgotten when so many later ones saw what it holds", .min = 1});
    v.field("own_share", c.own_share,
            {.doc = "... but for less than this share of its cells",
             .unit = "1",
             .min = 0.01,
             .max = 0.9});
  }
};

}  // namespace strata::slam
