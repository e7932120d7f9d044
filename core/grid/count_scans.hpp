// SPDX-License-Identifier: Apache-2.0
/// Counting many scans at once, on several threads, with the same bits for any number of them.
#pragma once

#include <span>

#include "core/base/parallel.hpp"
#include "core/base/progress.hpp"
#include "core/grid/counting_map.hpp"

namespace strata {

/// The counts of all scans. The log is cut into at most eight stretches by its length alone, each
/// counted in order, and their maps are added in order: up to rounding the same as adding one scan
/// after the other, and exactly so below 128 scans. The rectangle covers all rays tightly.
/// Throws Cancelled. O(beams x cells a beam crosses); memory: the sum, and the map of a stretch per
/// thread.
[[nodiscard]] CountingMap count_scans(std::span<const PosedScan> scans, double resolution_m,
                                      const CountingOptions& options, BeamWeights weights,
                                      WorkerPool& pool, Progress* progress = nullptr);
/// The same for some scans out of many, none of them null.
[[nodiscard]] CountingMap count_scans(std::span<const PosedScan* const> scans, double resolution_m,
                                      const CountingOptions& options, BeamWeights weights,
                                      WorkerPool& pool, Progress* progress = nullptr);

/// The cells between its ends. O(1).
[[nodiscard]] CellRect extent_of(const Ray& ray, double resolution_m);
/// The cells that the rays of a scan cover, as the smallest rectangle. O(beams).
[[nodiscard]] CellRect extent_of(const PosedScan& scan, double resolution_m,
                                 const CountingOptions& options);

}  // namespace strata
