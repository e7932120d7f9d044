// SPDX-License-Identifier: Apache-2.0
/// Figures of [stachniss2003chapter] that are drawings with words: 1.14 and 1.18.
#pragma once

#include "tools/laboratory/paper/figure.hpp"

namespace strata::paper {

/// Figure 1.14: the way through a changeable area with the times of entering and leaving.
[[nodiscard]] Outcome way_with_time_labels(const Setting& setting);
/// Figure 1.18: the centroids of one, two, ... clusters, and how 17 local maps belong to them.
[[nodiscard]] Outcome rows_of_centroids(const Setting& setting);

}  // namespace strata::paper
