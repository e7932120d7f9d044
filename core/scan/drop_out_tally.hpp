// SPDX-License-Identifier: Apache-2.0
/// What is counted of a scanner's beams without return, and what follows of it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/scan/drop_outs.hpp"

namespace strata {

/// By distance, in parts of the scanner's reach.
class DropOutTally {
 public:
  static constexpr std::size_t kBins = 16;
  /// The last piece of a reach is left out: noise decides there.
  static constexpr double kTrusted = 0.95;

  /// A return from beyond this share of the reach is far.
  static constexpr double kFar = 0.75;

  /// A beam without return that could be judged.
  void add_no_return() { ++no_returns_; }
  /// A far return, in a scan whose beams without return could be judged.
  void add_far() { ++far_; }
  /// A beam that met a surface at that share of the reach, below kTrusted.
  void add_surface(double share_of_reach, bool is_dropped) {
    const auto bin = static_cast<std::size_t>(share_of_reach * static_cast<double>(kBins));
    ++met_[bin];
    if (is_dropped) ++dropped_[bin];
  }
  void add(const DropOutTally& other);

  /// How far beams without return are believed; 0: not at all.
  [[nodiscard]] double free_range_m(double reach_m, const NoReturnConfig& config) const;
  /// Adds what was counted to `sum`.
  void report(DropOuts& sum) const;

  /// For saved states.
  template <class Self, class Archive>
  static void state(Self& self, Archive& archive) {
    for (auto& count : self.met_) archive(count);
    for (auto& count : self.dropped_) archive(count);
    archive(self.no_returns_);
    archive(self.far_);
  }

 private:
  std::array<std::uint64_t, kBins> met_{};
  std::array<std::uint64_t, kBins> dropped_{};
  std::uint64_t no_returns_ = 0;
  std::uint64_t far_ = 0;
};

}  // namespace strata
