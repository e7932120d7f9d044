// SPDX-License-Identifier: Apache-2.0
/// What users may know of a log that it does not say.
#pragma once

#include "core/base/config.hpp"

namespace strata::log {

struct LogConfig {
  double max_range_m = 0.0;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("max_range_m", c.max_range_m,
            {.doc = "readings from here on say that nothing came back, whatever the log states; 0: "
                    "what it "
                    "states, or, where readings pile up below that, what they tell",
             .unit = "m",
             .min = 0.0,
             .max = 1000.0,
             .when = "`strata info` takes hits for no return, or no returns for hits"});
  }
};

}  // namespace strata::log
