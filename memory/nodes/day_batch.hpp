// SPDX-License-Identifier: Apache-2.0
/// What a node gathers in a day for the levels that learn by days.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/state_archive.hpp"
#include "core/base/time.hpp"
#include "core/random/stream.hpp"
#include "memory/levels/node_level.hpp"

namespace strata::memory {

/// An even sample of the scans of one day: of the k-th, each place keeps capacity / k. A day ends
/// at midnight of the scans' clock, and with its run.
class DayBatch {
 public:
  DayBatch(const PolarBins& bins, int capacity) : seen_(bins, capacity, false) {}

  [[nodiscard]] bool empty() const { return scans_ == 0; }
  [[nodiscard]] const NodeLevel& seen() const { return seen_; }
  /// Whether a scan belongs to a later day than those gathered, or the clock was set back by days.
  [[nodiscard]] bool is_over(int run, Stamp stamp) const;
  /// Changes whenever the content does.
  [[nodiscard]] std::uint64_t revision() const { return (closed_ << 32U) + scans_; }
  void add(const VirtualScan& scan, int run, Stamp stamp, RandomStream& random);

  /// Days since the latest end of a batch before that the clock has come past again. A run within
  /// the time of another, and a clock that was set back, say nothing of the time between them: a
  /// day each, as the first.
  [[nodiscard]] double days() const;
  /// Begins the next one.
  void close();

  [[nodiscard]] std::size_t bytes() const;
  /// For core/base/state_archive.hpp; bins and capacity are the constructor's.
  template <class Self, class Archive>
  static void state(Self& self, Archive& archive) {
    archive(self.scans_);
    archive(self.closed_);
    archive(self.span_);
    archive(self.before_);
    archive(self.seen_);
    if constexpr (Archive::kReads) {
      if (archive.is_at_end()) return;  // of an older version
    }
    archive(self.earlier_);
  }

 private:
  struct Span {
    std::int64_t run = 0;
    Stamp begin;
    Stamp end;
  };
  NodeLevel seen_;
  std::uint64_t scans_ = 0;
  Span span_;
  std::uint64_t closed_ = 0;  ///< batches before this one
  Span before_;
  /// Ends of batches by a clock that was set back afterwards and has not come past them since,
  /// the latest first.
  std::vector<Stamp> earlier_;
};

}  // namespace strata::memory
