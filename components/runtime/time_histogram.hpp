// SPDX-License-Identifier: Apache-2.0
/// How long something took, of many times, in a few numbers.
#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace strata::runtime {

/// Counts by fixed bounds, as Prometheus' histograms: cumulative, and the sum beside them. Not
/// thread safe.
class TimeHistogram {
 public:
  static constexpr std::array<double, 11> kBounds_s{0.0005, 0.001, 0.002, 0.005, 0.01, 0.02,
                                                    0.05,   0.1,   0.2,   0.5,   1.0};

  /// One more time [s]; a negative one, as where two clocks differ, counts as 0, and one that is no
  /// number as longer than every bound, without adding to the sum. O(bounds).
  void add(double time_s);
  [[nodiscard]] std::uint64_t count() const { return count_; }
  /// "0.0005:0 0.001:3 ... 1:9 inf:10 sum:1.25": how many took at most so long [s], and all
  /// together.
  [[nodiscard]] std::string text() const;

 private:
  std::array<std::uint64_t, kBounds_s.size()> up_to_{};
  std::uint64_t count_ = 0;
  double sum_s_ = 0.0;
};

}  // namespace strata::runtime
