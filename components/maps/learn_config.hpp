// SPDX-License-Identifier: Apache-2.0
/// Everything that can be set about learning, one group a part.
#pragma once

#include "core/patch/patch_learner.hpp"
#include "core/scan/history.hpp"
#include "core/slam/slam.hpp"
#include "memory/nodes/timescale_memory.hpp"

namespace strata::maps {

struct LearnConfig {
  slam::SlamConfig slam;
  patch::PatchLearnerConfig patch;
  memory::TimescaleConfig timescale;
  HistoryConfig history;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.group("slam", c.slam, "poses, beam filter and the two grid maps");
    v.group("patch", c.patch, "sub-maps and their configurations");
    v.group("timescale", c.timescale, "the timescale memory");
    v.group("history", c.history, "what `--update` keeps of earlier runs");
  }
};

}  // namespace strata::maps
