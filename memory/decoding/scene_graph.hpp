// SPDX-License-Identifier: Apache-2.0
/// The graph of EdgeWeight::kScene: which range bins belong to one scene, and how often it was
/// seen.
#pragma once

#include "memory/decoding/decoding_config.hpp"
#include "memory/decoding/graph.hpp"
#include "memory/levels/node_level.hpp"

namespace strata::memory::detail {

/// The product of conditional probabilities decides between two scenes where they part, by the
/// samples of one angle bin, and pays for the noise of ranges within a scene on every step: less
/// for a rare scene, whose few samples show less of it. Here a step from range bin i to j has
///
///     p = min(1, P(j | i) / P(j), P(i | j) / P(i)) * P(j)^w
///
/// So a step within a scene costs nothing, however its ranges scatter; one that contradicts what
/// was seen together costs ln of the number of times that it could have been seen; and all bins on
/// the way vote. w is small, so that bins that were not seen for long follow their neighbours.
/// Probabilities are shares of samples and pairs; `smoothing` observations of independent bins are
/// added. Range bins beside count half, as a condition a fifth.
///
/// Every row with samples has one more state, the wildcard: the scene was never seen in this angle
/// bin, and all of its samples are of others. It costs -ln of the probability that two of those
/// show one surface, besides the vote that the commonest state would have, and is entered and left
/// where a state has samples, but no pairs.
///
/// There is no prior of the first row. O(angle bins x (pairs + states^2)).
[[nodiscard]] LayeredGraph build_scene_graph(const NodeLevel& level, const DecodingConfig& config);

}  // namespace strata::memory::detail
