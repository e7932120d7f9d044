// SPDX-License-Identifier: Apache-2.0
/// One time level of one node: sample sets and co-occurrence pairs [kessler2010what, sections 3,
/// 4].
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/state_archive.hpp"
#include "core/random/stream.hpp"
#include "memory/levels/polar_bins.hpp"
#include "memory/levels/virtual_scan.hpp"

namespace strata::memory {

/// Range bins that one scan saw in an angle bin and in the next; PolarBins::state_bin.
struct RangePair {
  std::uint8_t alpha = 0;
  std::uint8_t beta = 0;
  friend bool operator==(const RangePair&, const RangePair&) = default;
};

/// Per angle bin a a set of at most N ranges, and for (a, a + 1) a set of at most N pairs, the
/// entries of the paper's co-occurrence matrix S_a. A full set gives up a uniformly random element
/// for each new one.
///
/// The paper also drops a random pair of the same range bin whenever a sample leaves
/// (`coupled_eviction`). At the edge of a field of view samples come without partners, so that this
/// drains the pairs until no path is left; by default pairs make way for pairs only.
class NodeLevel {
 public:
  NodeLevel(const PolarBins& bins, int capacity, bool coupled_eviction);

  [[nodiscard]] const PolarBins& bins() const { return bins_; }
  [[nodiscard]] int capacity() const { return static_cast<int>(capacity_); }
  /// In no order; +Inf for the overflow bin, -f for no nearer than f.
  [[nodiscard]] std::span<const float> samples(int angle_bin) const;
  [[nodiscard]] std::span<const RangePair> pairs(int angle_bin) const;
  /// How many scans were inserted; changes whenever the content does.
  [[nodiscard]] std::uint64_t insertions() const { return insertions_; }
  [[nodiscard]] std::size_t sample_count() const;
  [[nodiscard]] std::size_t pair_count() const;

  /// Takes in every known bin of the scan and every pair of known neighbours. Requires bins().
  /// angle_bins ranges. O(angle bins).
  void insert(const VirtualScan& scan, RandomStream& random);

  /// Lets every sample and pair make way, with probability `share`, for a random one that `newer`
  /// has in the same place; free places are filled up. Places that `newer` knows nothing of stay.
  /// Same bins. O(angle bins x samples).
  void absorb(const NodeLevel& newer, double share, RandomStream& random);
  /// As it was made, but for insertions().
  void clear();

  /// For core/base/state_archive.hpp; bins and capacity are the constructor's.
  template <class Self, class Archive>
  static void state(Self& self, Archive& archive) {
    archive(self.insertions_);
    archive.values(std::span(self.sample_counts_));
    archive.values(std::span(self.pair_counts_));
    if constexpr (Archive::kReads) {
      if (!self.has_room()) archive.fail("holds more samples than its level may");
    }
    for (std::size_t a = 0; a < self.sample_counts_.size(); ++a) {
      const std::size_t from = a * self.capacity_;
      archive.values(std::span(self.samples_).subspan(from, self.sample_counts_[a]));
      archive.values(std::span(self.pairs_).subspan(from, self.pair_counts_[a]));
    }
    if constexpr (Archive::kReads) {
      if (!self.is_sound()) archive.fail("holds a range that is none, or a pair outside the bins");
    }
  }

 private:
  /// Whether no count is beyond the capacity.
  [[nodiscard]] bool has_room() const;
  /// Whether every sample is a range, and every pair of two range bins.
  [[nodiscard]] bool is_sound() const;
  void insert_sample(std::size_t bin, float range_m, RandomStream& random);
  void insert_pair(std::size_t bin, RangePair pair, RandomStream& random);
  void drop_pair_from(std::size_t bin, std::uint8_t alpha, RandomStream& random);

  PolarBins bins_;
  std::size_t capacity_;
  bool coupled_eviction_;
  std::uint64_t insertions_ = 0;
  std::vector<std::uint16_t> sample_counts_;  ///< per angle bin
  std::vector<std::uint16_t> pair_counts_;
  std::vector<float> samples_;  ///< capacity_ places an angle bin
  std::vector<RangePair> pairs_;
};

}  // namespace strata::memory
