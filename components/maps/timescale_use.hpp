// SPDX-License-Identifier: Apache-2.0
/// How a timescale memory is used while a robot is localized in it.
#pragma once

namespace strata::maps {

struct TimescaleUseConfig {
  bool base_map = true;
  double min_score = 0.0;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field(
        "base_map", c.base_map,
        {.doc = "where the memory says nothing of a beam, what the filtered map expects counts, "
                "if there is one"});
    v.field("min_score", c.min_score,
            {.doc = "the memory takes in a scan only when the score of its pose is at least this "
                    "and its health is in no doubt",
             .min = 0.0,
             .max = 1.0});
  }
};

}  // namespace strata::maps
