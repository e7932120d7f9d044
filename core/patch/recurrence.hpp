// SPDX-License-Identifier: Apache-2.0
/// Whether what is seen at a changeable place comes back (docs/theory/patch_maps.md, "Recurrence").
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/base/config.hpp"
#include "core/patch/patch_map.hpp"
#include "core/patch/sequence_history.hpp"

namespace strata::patch {

struct RecurrenceConfig {
  double min_probability = 0.06;

  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("min_probability", c.min_probability,
            {.doc = "an area is left out where what comes to it next is less probably something "
                    "that was there before: a map of what never returns says where things are not; "
                    "0: every area is kept",
             .unit = "1",
             .min = 0.0,
             .max = 1.0,
             .preset = {"paper-patch", "0"}});
  }
};

/// Of one sub-map. looks[i]: how likely what entry i of the history saw is in each configuration,
/// to a factor; entries that do not tell are left out. What stays while it is looked at again has
/// appeared once; what is seen after a time that nobody knows has appeared again.
/// O(sequences x configurations + transitions).
[[nodiscard]] Recurrence recurrence_of(std::span<const std::vector<double>> looks,
                                       const SequenceHistory& history);

/// The same by the memberships of a sub-map's sequences, which are saved and sent with it: who gets
/// the map by a message finds the same bits. O(sequences x configurations).
[[nodiscard]] Recurrence recurrence_of(const Submap& submap);

/// For each sub-map of a map, P(what comes next was there before): (r + q) / (n + 1) for r returns
/// of n chances, as with one appearance beforehand that returned as often as those of all sub-maps
/// together, q = (R + 2) / (N + 3): few visits are no reason to doubt that things return. Ours.
/// O(sub-maps).
[[nodiscard]] std::vector<double> return_probabilities(std::span<const Recurrence> submaps);

}  // namespace strata::patch
