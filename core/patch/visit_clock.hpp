// SPDX-License-Identifier: Apache-2.0
/// Which visits go on, and whether what they see has changed (docs/theory/patch_maps.md, "Visits").
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <utility>

#include "core/base/time.hpp"
#include "core/patch/visits.hpp"

namespace strata::patch {

/// The time of visits while scans come, in numbers of scans. Scans are ordered by run, then time.
class VisitClock {
 public:
  explicit VisitClock(const VisitConfig& config) : config_(config) {}

  /// Time has come to the scan of that number. O(1) amortized.
  void advance(int run, Stamp stamp, std::uint32_t scan);

  /// Scans from here on are within the gap of the newest one, and of its run.
  [[nodiscard]] std::uint32_t joins_from() const { return joins_from_; }
  [[nodiscard]] bool goes_on(const Visit& visit) const { return visit.last_scan >= joins_from_; }
  /// Whether a visit that goes on has lasted for as long as a state has to.
  [[nodiscard]] bool is_settled(const Visit& visit) const {
    return visit.first_scan < settled_before_;
  }
  /// Whether a beam speaks against the state that a visit shows clearly, so that it may be the
  /// first of another.
  [[nodiscard]] static bool speaks_against(const Visit& visit, bool is_hit);
  /// A visit's beams in the time for which a state may be interrupted, at least 4: what speaks for
  /// a change is not counted further (the sum of [page1954continuous], bounded).
  [[nodiscard]] float most_lead(const Visit& visit, std::uint32_t now) const;
  /// Whether the first visit shows one state clearly and the second the other.
  [[nodiscard]] static bool is_change(const Visit& before, const Visit& after);

  [[nodiscard]] std::size_t bytes() const {
    return (recent_.size() + young_.size()) * sizeof(std::pair<std::uint32_t, Stamp>);
  }

  /// For core/base/state_archive.hpp; without changes in view as before they were looked for.
  template <class Self, class Archive>
  static void state(Self& self, Archive& archive, bool has_changes) {
    archive(self.recent_);
    archive(self.run_);
    archive(self.joins_from_);
    if (!has_changes) return;
    archive(self.young_);
    archive(self.settled_before_);
  }

 private:
  VisitConfig config_;
  std::deque<std::pair<std::uint32_t, Stamp>> recent_;  // scans within the gap, of this run
  std::optional<int> run_;
  std::uint32_t joins_from_ = 0;  // a visit that saw this scan or a later one goes on
  std::deque<std::pair<std::uint32_t, Stamp>> young_;  // within min_state_s, of this run
  std::uint32_t settled_before_ = 0;  // of this run, earlier scans are older; 0: none
};

}  // namespace strata::patch
