// SPDX-License-Identifier: Apache-2.0
/// What one sequence says about a sub-map as a vector for clustering (SPEC B4).
#pragma once

#include <span>
#include <vector>

#include "core/grid/counting_map.hpp"
#include "core/grid/grid.hpp"
#include "core/grid/reflection_grid.hpp"

namespace strata::patch {

/// The beam filter at fixed poses on the counts of one sequence, by its closed form (SPEC A5):
/// people walking by are gone, what stays for the sequence stays. Unknown below min_evidence.
/// Requires prior in (0.5, 1]. O(cells).
[[nodiscard]] ReflectionGrid filter_counts(const Grid<CellCounts>& counts, double prior,
                                           double min_evidence);

/// One entry per given cell: the greatest known reflection of its 3 x 3 block, unknown (NaN) when
/// none is known. The block forgives errors of pose up to a cell; clustering on all cells of the
/// rectangle instead finds poses, not states. O(cells).
[[nodiscard]] std::vector<float> feature_vector(const ReflectionGrid& reflection,
                                                std::span<const Cell> cells);

}  // namespace strata::patch
