// SPDX-License-Identifier: Apache-2.0
/// Learns the chain of every cell from scans at known poses (docs/theory/cells.md, "Learning").
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/parallel.hpp"
#include "core/cells/cell_map.hpp"
#include "core/patch/sequence_history.hpp"
#include "core/scan/scan.hpp"

namespace strata::cells {

/// Scans are cut into looks at each cell; looks that decide are the sequence that a chain explains.
class CellLearner {
 public:
  explicit CellLearner(double resolution_m, const CellConfig& config = {});

  /// Runs one after the other, scans in order of time within a run; all beams count. Stamps that
  /// go back begin a look that follows none at a known time. O(beams x cells a beam crosses).
  void add(const PosedScan& scan);

  /// The chains. Ends all looks: nothing can be added then. The same bits for any number of
  /// threads. O(cells + cells that changed x O(learn_chain)).
  [[nodiscard]] CellMap finish(WorkerPool& pool);

 private:
  /// Looks that showed the same as the one before.
  struct Same {
    float count = 0.0F;
    float time_s = 0.0F;
  };
  struct Watch {
    float hits = 0.0F;
    float misses = 0.0F;
    std::int32_t run = -1;
    std::int32_t history = -1;  ///< of a cell that has changed
    Stamp begin;
    Stamp end;
    Stamp last_middle;            ///< of the last look that decided
    std::array<Same, 2> same{};   ///< before the first change: soon after each other, and later
    float firsts = 0.0F;          ///< looks that follow none at a known time
    std::int8_t last_state = -1;  ///< 0 free, 1 occupied
  };
  void look(const PosedScan& scan, Watch& watch);
  void end_look(Watch& watch);
  void add_look(int state, double dt_s, Watch& watch);
  [[nodiscard]] CellState static_cell(const Watch& watch, const CellMap& map) const;
  [[nodiscard]] CellState changing_cell(const Watch& watch, const patch::ChainConfig& config) const;
  /// What the whole map says of its cells beforehand.
  void pool_prior(CellMap& map) const;

  CellConfig config_;
  BeamEvidence evidence_;
  TiledGrid<Watch> watches_;
  std::vector<patch::SequenceHistory> histories_;  // entries: free, occupied, the last look
  double changes_ = 0.0;
  double sames_ = 0.0;
};

}  // namespace strata::cells
