// SPDX-License-Identifier: Apache-2.0
/// The inner loop of the layered search, in vector code chosen at run time.
#pragma once

#include <cstddef>

namespace strata::memory::detail {

/// Starts are padded to a multiple of this, the widest vector of doubles.
inline constexpr std::size_t kStartLanes = 8;

/// to[j][s] = min over i of (from[i][s] + edges[i][j]) for all starts s < stride. from: states x
/// stride, edges: states x width, to: width x stride, all row by row; stride a multiple of
/// kStartLanes. Additions and minima only, so every target gives the same bits.
void relax(const double* from, const double* edges, std::size_t states, std::size_t width,
           std::size_t stride, double* to);

}  // namespace strata::memory::detail
