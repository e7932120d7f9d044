// SPDX-License-Identifier: Apache-2.0
/// The visits of every cell while scans come one by one, in bounded memory.
///
/// Unlike find_visits it cannot know which cells will be hit later, so it keeps visits of free
/// cells too; of a cell with too many visits it forgets the oldest of the more frequent kind, so
/// that the rarer state of a door outlives any number of visits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/grid/reflection_grid.hpp"
#include "core/patch/visit_chains.hpp"
#include "core/patch/visit_clock.hpp"
#include "core/patch/visits.hpp"

namespace strata::patch {

class VisitStore {
 public:
  /// most: visits kept of one cell, at least 2.
  VisitStore(double resolution_m, const VisitConfig& config, const CountingOptions& counting,
             int most);

  /// Time has come to the scan of that number; visits that have ended by then may be taken before
  /// it is added. Scans are ordered by run, then time, and numbered upwards. O(1) amortized.
  void advance(const PosedScan& scan, std::uint32_t index);
  /// The scan that time has come to. O(beams x cells a beam crosses).
  void add(const PosedScan& scan, std::uint32_t index);
  /// Tiles with news that nobody has looked at for longer than the gap, so that all their visits
  /// have ended, or where something changed in view; those of one window of at most window_m. They
  /// count as seen to from now on. O(area / tile area).
  [[nodiscard]] std::vector<CellRect> take_ended(double window_m);
  /// As find_visits over all scans so far, within the window: the cells that some beam ended in. O(
  /// cells of the window and their visits).
  [[nodiscard]] VisitTable table(const CellRect& window) const;
  [[nodiscard]] const CellRect& rect() const { return last_.rect(); }
  /// `known` with what the visits say of the cells that it does not know, by the beam filter's
  /// closed form over all visits that are kept. O(cells and visits of those cells).
  [[nodiscard]] ReflectionGrid extended(const ReflectionGrid& known, double prior,
                                        double min_evidence) const;

  /// For core/base/state_archive.hpp; settings are not part of it. Without changes in view as
  /// before they were looked for.
  template <class Self, class Archive>
  static void state(Self& self, Archive& archive, bool has_changes) {
    const double resolution_m = self.last_.resolution_m();
    archive(self.max_);
    archive(self.last_);
    VisitChains::state(self.chains_, archive, has_changes);
    archive(self.touched_);
    VisitClock::state(self.clock_, archive, has_changes);
    if (has_changes) archive(self.changed_);
    if constexpr (Archive::kReads) {
      if (!has_changes) {
        self.changed_ = Grid<std::uint8_t>(self.touched_.resolution_m(), self.touched_.rect(), 0);
      }
      if (!self.is_sound(resolution_m)) archive.fail("has damaged visits");
    }
  }

  [[nodiscard]] std::size_t bytes() const;
  [[nodiscard]] int most() const { return max_; }
  /// Keeps at most so many visits of each cell from now on. O(cells and visits).
  void trim(int most);

 private:
  /// Whether every index of a visit leads to one, and to none twice.
  [[nodiscard]] bool is_sound(double resolution_m) const;

  VisitConfig config_;
  CountingOptions options_;
  int max_;
  Grid<std::int32_t> last_;  // newest visit of each cell; -1: none
  VisitChains chains_;
  Grid<std::uint32_t> touched_;  // per tile: 1 + the last scan that saw it; 0: no news
  VisitClock clock_;
  Grid<std::uint8_t> changed_;  // per tile, as touched_: 1 where something changed in view
};

}  // namespace strata::patch
