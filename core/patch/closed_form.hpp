// SPDX-License-Identifier: Apache-2.0
/// The fixed point of the beam filter's EM at fixed poses, for one cell (SPEC A5).
#pragma once

#include <algorithm>

#include "core/grid/counting_map.hpp"

namespace strata::patch {

/// m = clip[(p r + p - 1) / (2 p - 1), 0, 1] with r = hits / total: what iterating (1.10)-(1.15) of
/// [stachniss2003chapter] at fixed poses converges to. Requires evidence and prior in (0.5, 1].
[[nodiscard]] inline double closed_form(const CellCounts& counts, double prior) {
  const double r = counts.hits / counts.total();
  return std::clamp((prior * r + prior - 1.0) / (2.0 * prior - 1.0), 0.0, 1.0);
}

}  // namespace strata::patch
