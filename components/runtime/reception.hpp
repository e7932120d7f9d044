// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

namespace strata::runtime {

/// How a component takes the messages of a topic, live.
struct Reception {
  /// What comes of one writer within this is taken for one thing: the history that it keeps for who
  /// comes late, or transforms that it tells one by one.
  static constexpr std::chrono::seconds kBurst{1};
  int min_waiting = 0;    ///< as many may wait while it is busy, where the profile says fewer
  bool at_ticks = false;  ///< all that came, at each tick: later, but nobody is woken for each
  /// Latched messages wait while it is inactive: of each writer the last so many, or all of its
  /// last burst if that is more; 0: all that the profile has room for.
  int latched_depth = 0;
  /// Messages that are not latched wait while it is inactive, too, as many as the profile keeps;
  /// others are passed over then.
  bool until_active = false;
};

}  // namespace strata::runtime
