// SPDX-License-Identifier: Apache-2.0
/// When a sub-map changed while the robot looked, and what that does to its sequences
/// (docs/theory/patch_maps.md, "Sequences").
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/patch/sequences.hpp"
#include "core/patch/visits.hpp"
#include "core/scan/scan.hpp"

namespace strata::patch {

/// The scans that were the first after a change in view, ascending: where the visits of at least
/// six of the cells were cut, each within a second of the next; the median of these. scans: the
/// first is number first_scan; changes before it are left out. O(visits of the cells, sorted).
[[nodiscard]] std::vector<std::uint32_t> changes_in_view(const VisitTable& table,
                                                         std::span<const Cell> cells,
                                                         std::span<const PosedScan> scans,
                                                         std::uint32_t first_scan, double gap_s);

/// The parts of a sequence before, between and after the changes, those of at least min_scans
/// scans; the whole where there are none. O(scans of the sequence + changes).
[[nodiscard]] std::vector<Sequence> cut_at(const Sequence& sequence,
                                           std::span<const std::uint32_t> changes, int min_scans);

}  // namespace strata::patch
