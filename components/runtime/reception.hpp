// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace strata::runtime {

/// How a component takes the messages of a topic, live.
struct Reception {
  int min_waiting = 0;    ///< as many may wait while it is busy, where the profile says fewer
  bool at_ticks = false;  ///< all that came, at each tick: later, but nobody is woken for each
};

}  // namespace strata::runtime
