// SPDX-License-Identifier: Apache-2.0
/// Parameters of strata::PatchLearner.
#pragma once

#include <string>

#include "core/patch/patch_learner.hpp"

namespace strata::patch_learner {

struct PatchLearnerComponentConfig {
  patch::PatchLearnerConfig patch;
  std::string map_frame = "map";
  int learn_every_scans = 0;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.group("patch", c.patch, "sub-maps and their configurations");
    v.field("map_frame", c.map_frame, {.doc = "frame of the map out"});
    v.field("learn_every_scans", c.learn_every_scans,
            {.doc = "live: learn anew from all scans after so many; 0: never. Takes seconds",
             .unit = "scans",
             .min = 0.0});
  }
};

}  // namespace strata::patch_learner
