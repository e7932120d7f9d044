// SPDX-License-Identifier: Apache-2.0
/// Places whose visits contradict each other, and what each visit found different.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/grid/grid.hpp"
#include "core/patch/contradiction.hpp"
#include "core/patch/visits.hpp"

namespace strata::pipeline {

enum class CellState : std::uint8_t { kUnknown, kFree, kOccupied };

/// A change of a place before anyone looked at beams.
struct ChangeCandidate {
  std::size_t first_scan = 0;
  std::size_t last_scan = 0;
  bool is_tested = false;  ///< begins in the test part
  bool is_old_state = false;
  std::vector<std::pair<Cell, CellState>> cells;
};

/// Cells whose visits contradict each other, over all time or about the split. learned_scans: scans
/// from this one on are tested.
[[nodiscard]] Grid<std::uint8_t> find_places(const patch::VisitTable& table, double resolution_m,
                                             std::size_t learned_scans,
                                             const patch::ContradictionConfig& config);

/// Goes through the visits of each place (a component of the mask) in time; in the order in which
/// they begin. O(visits x cells).
[[nodiscard]] std::vector<ChangeCandidate> find_candidates(const patch::VisitTable& table,
                                                           const Grid<std::uint8_t>& mask,
                                                           const patch::ContradictionConfig& config,
                                                           std::size_t learned_scans);

}  // namespace strata::pipeline
