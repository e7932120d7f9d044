// SPDX-License-Identifier: Apache-2.0
/// The doors that changed between the three runs of Wean Hall, and whether a patch map knows them.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/patch/patch_map.hpp"
#include "core/patch/visits.hpp"
#include "core/scan/scan.hpp"

namespace strata::experiments {

enum class DoorState { kUnseen, kOpen, kClosed };

/// A row of the table of the data's README.
struct WeanDoor {
  Eigen::Vector2d middle_m;              ///< map frame
  std::array<DoorState, 3> in_run = {};  ///< runs 1, 2, 3

  /// Whether both runs (from 0) saw it, each in another state.
  [[nodiscard]] bool differs(int run_a, int run_b) const;
};
[[nodiscard]] std::span<const WeanDoor> wean_doors();

/// Whether some cells of the sub-map that changed lie at the door: within 0.5 m, since the table is
/// measured at reference poses good to 0.1 m across and 0.3 m along the corridor.
[[nodiscard]] bool covers(const patch::Submap& submap, const WeanDoor& door);

/// What the scans themselves say, whatever the table does: the cells within 0.6 m of the door that
/// one of the runs hit and the other saw through, by the evidence that the learner asks of a few
/// visits, but of each cell by itself. visits: of the scans, after VisitTable::filter.
[[nodiscard]] std::size_t cells_apart(const patch::VisitTable& visits,
                                      std::span<const PosedScan> scans, const WeanDoor& door,
                                      int run_a, int run_b);

/// Whether the sub-map has the door in the two states: what the sequences of run_a mostly chose
/// and what those of run_b did are two configurations, which show different things in more than
/// four fifths of the cells at the door that changed. Runs from 0, ids of the sequences.
[[nodiscard]] bool has_both_states(const patch::Submap& submap, const WeanDoor& door, int run_a,
                                   int run_b);

}  // namespace strata::experiments
