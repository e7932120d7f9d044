// SPDX-License-Identifier: Apache-2.0
/// Whether what a robot saw of a place on different ways fits together in the map.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/base/parallel.hpp"
#include "core/scan/scan.hpp"

namespace strata::slam {

/// Two stretches of the way that saw the same place.
struct ComparedStretches {
  double x_m = 0.0;  ///< the middle of what contradicts, or else of what both saw
  double y_m = 0.0;
  int first_run = 0;
  int second_run = 0;
  Stamp first;  ///< the middle of each
  Stamp second;
  std::size_t cells = 0;  ///< with a surface by one that the other saw as free or as a surface
  double share = 0.0;     ///< of those cells, seen as free by the other
};

struct Consistency {
  bool consistent = true;
  std::size_t compared = 0;       ///< pairs of stretches that saw enough in common
  std::size_t contradicting = 0;  ///< of those
  std::size_t fitting_cells = 0;  ///< with a surface by one of a pair, and near one by the other
  std::size_t contradicting_cells = 0;  ///< ... and free by the other
  /// Runs that contradict the others by themselves: of many runs one that was put into the map
  /// wrongly is too few pairs to be seen among all.
  std::vector<int> against_others;
  /// Of those that contradict the worst first; of several within 5 m the worst alone.
  std::vector<ComparedStretches> places;

  /// How much of what was seen on several ways agrees, less what contradicts [cells].
  [[nodiscard]] double agreement_cells() const {
    return static_cast<double>(fitting_cells) - static_cast<double>(contradicting_cells);
  }
};

/// Cuts the way into stretches of a few metres, draws what each saw of static surfaces near it, and
/// compares those that overlap: a surface in the other's free space, away from the other's
/// surfaces, is a contradiction. What changed in between contradicts in few cells; a map that was
/// folded, bent or put together wrongly in many. Our own, not in the papers;
/// docs/theory/slam.md, "Consistency". The same bits at any number of threads.
/// O(beams x cells + pairs that overlap x cells); memory by the way.
[[nodiscard]] Consistency check_consistency(std::span<const PosedScan> scans, WorkerPool& pool);

/// All pairs that saw enough in common, for those who set limits.
[[nodiscard]] std::vector<ComparedStretches> compare_stretches(std::span<const PosedScan> scans,
                                                               WorkerPool& pool);

}  // namespace strata::slam
