// SPDX-License-Identifier: Apache-2.0
/// How often the kept sequences of a sub-map were seen, and which came after which.
///
/// Sequences are pooled to bound memory. What the pooled ones say of how often configurations are
/// there, and of how fast they change, must not go with them (docs/theory/patch_maps.md, "Chain").
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/time.hpp"
#include "core/patch/patch_map.hpp"

namespace strata::patch {

/// A sequence of entry `to`, which began in that hour of the week, followed one of entry `from`,
/// `count` times, dt_s later in the mean.
struct Transition {
  std::uint32_t from = 0;
  std::uint32_t to = 0;
  double dt_s = 0.0;  ///< from the end of one to the beginning of the next, above 0
  double count = 0.0;
  std::int64_t hour = kUnknownHour;  ///< in [0, 168)
  static constexpr std::int64_t kUnknownHour = -1;
  bool operator==(const Transition&) const = default;
};

/// On how many different days, and in how many different weeks, something was seen. Days and weeks
/// begin as in core/periodic/periodic_shares.hpp.
struct SeenDays {
  std::int64_t days = 0;
  std::int64_t weeks = 0;
  std::int64_t newest_day = 0;  ///< since the epoch
  bool operator==(const SeenDays&) const = default;
};

/// One entry a kept sequence, in the same order as these.
class SequenceHistory {
 public:
  SequenceHistory() = default;
  /// So many entries that stand for nothing yet.
  explicit SequenceHistory(std::size_t entries) : counts_(entries, 0.0) {}

  /// Another sequence, which began at `begin`, dt_s after the last one ended; 0 or less: nobody
  /// knows how much later (the first; runs whose stamps overlap). O(1) amortized.
  void append(double dt_s, Stamp begin = {});
  /// Entry `from` goes, and what it stood for counts for entry `into`. O(transitions).
  void pool(std::size_t from, std::size_t into);
  /// Entry i, which stands for one sequence, was two: the second is entry i + 1 now, begun at
  /// `begin`, dt_s after the first ended. O(transitions).
  void split(std::size_t i, double dt_s, Stamp begin = {});
  /// Adds what another history has seen of its entries, places[i] here of entry i there; kGone:
  /// forgotten, with what came before and after it. O(its transitions x these).
  void add(const SequenceHistory& other, std::span<const std::uint32_t> places);

  bool operator==(const SequenceHistory&) const = default;

  static constexpr std::uint32_t kGone = 0xFFFFFFFFU;

  /// Sequences that each entry stands for; 1 unless pooled.
  [[nodiscard]] const std::vector<double>& counts() const { return counts_; }
  /// None twice for the same entries, the same hour, and times alike to a factor of two.
  [[nodiscard]] const std::vector<Transition>& transitions() const { return transitions_; }
  [[nodiscard]] const SeenDays& seen() const { return seen_; }
  /// The same but for when: for those that were saved before it was kept.
  [[nodiscard]] bool is_alike_but_for_hours(const SequenceHistory& other) const;
  [[nodiscard]] std::size_t size() const { return counts_.size(); }
  [[nodiscard]] std::size_t bytes() const {
    return counts_.size() * sizeof(double) + transitions_.size() * sizeof(Transition);
  }

  /// For core/base/state_archive.hpp; without hours as before they were kept.
  template <class Self, class Archive>
  static void state(Self& self, Archive& archive, bool has_hours) {
    archive(self.counts_);
    if (has_hours) {
      archive(self.transitions_);
      archive(self.seen_);
    } else if constexpr (Archive::kReads) {
      std::vector<TransitionWithoutHour> transitions;
      archive(transitions);
      for (const auto& t : transitions)
        self.transitions_.push_back({t.from, t.to, t.dt_s, t.count});
    }
    if constexpr (Archive::kReads) {
      if (!self.is_sound()) archive.fail("has a damaged history");
    }
  }

 private:
  struct TransitionWithoutHour {
    std::uint32_t from = 0;
    std::uint32_t to = 0;
    double dt_s = 0.0;
    double count = 0.0;
  };
  [[nodiscard]] bool is_sound() const;
  void add_transition(const Transition& transition);
  void see(Stamp begin);
  std::vector<double> counts_;
  std::vector<Transition> transitions_;
  SeenDays seen_;
};

/// Of sequences none of which was pooled, in order of time. O(sequences).
[[nodiscard]] SequenceHistory history_of(std::span<const SequenceInfo> sequences);

}  // namespace strata::patch
