// SPDX-License-Identifier: Apache-2.0
/// What one sequence says as a vector to cluster (docs/theory/patch_maps.md, "Feature vectors").
#pragma once

#include <span>
#include <vector>

#include "core/grid/counting_map.hpp"
#include "core/grid/grid.hpp"
#include "core/grid/reflection_grid.hpp"

namespace strata::patch {

/// The beam filter on the counts of one sequence (docs/theory/beam_filter.md, "Closed form"):
/// people walking by are gone, what stays for the sequence stays. Unknown below min_evidence.
/// Requires prior in (0.5, 1]. O(cells).
[[nodiscard]] ReflectionGrid filter_counts(const Grid<CellCounts>& counts, double prior,
                                           double min_evidence);

/// One entry per given cell: the greatest known reflection of its 3 x 3 block, doubled and cut at
/// 1, since how far above 0.5 a surface reads depends on the angle of view. The block forgives
/// errors of pose up to a cell; clustering on all cells of the rectangle instead finds poses, not
/// states. Unknown (NaN) when nothing in the block reads 0.5 and the cell or one beside it is
/// unknown, or a surface lies within three cells: the hidden back of an object would be free in one
/// view and a surface in another, and what lies beside a surface is that surface under another
/// error of pose. O(cells).
[[nodiscard]] std::vector<float> feature_vector(const ReflectionGrid& reflection,
                                                std::span<const Cell> cells);

}  // namespace strata::patch
