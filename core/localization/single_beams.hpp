// SPDX-License-Identifier: Apache-2.0
/// Beams that may end at the cells of one box, all alike, or behind them: most of those that pass
/// where sub-maps change. A row of particles at a time, with the widest SIMD that the machine has.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "core/localization/ray_boxes.hpp"
#include "core/localization/scan_mixture.hpp"

namespace strata::localization {

/// Working memory: begin(), rows(), cast(), mix(); then what was found. Allocates nothing once
/// warm.
class SingleBeams {
 public:
  void begin() { rows_.count = 0; }
  /// The rows so far, with room for this many more.
  [[nodiscard]] SingleRows& rows(std::size_t more);
  /// Follows all of them through their boxes. table: of changing cells.
  void cast(const RayTable& table, const RayFans& fans);
  /// A beam met something in several boxes: calls take(beam, fan, first row, rows, lane) for each,
  /// and leaves it out from here on. Ranges are there until take returns.
  template <typename Take>
  void take_multiple(Take&& take);

  /// Number of rows; what they are; and where the beams of one met something, +infinity: nowhere.
  [[nodiscard]] std::size_t size() const { return rows_.count; }
  [[nodiscard]] const SingleRow& row(std::size_t n) const { return rows_.rows[n]; }
  [[nodiscard]] const double* range_m(std::size_t n) const {
    return range_m_.data() + n * RayFans::kVector;
  }

  /// A share of those that are not mixed.
  static constexpr double kApart = -1.0;
  /// Takes all of them out of logs[beam x fans + fan], which become 0, into sums: with probability
  /// share[box x fans + fan] such a beam ends at the cell that it met, else where logs says; or
  /// that is kept apart, with kApart. with_both: sums().near and far are wanted.
  void mix(const ScanMixture& mixture, std::size_t fans, std::span<const double> share,
           bool with_both, double* logs);

  /// Sums over the beams of a fan that met a box: of ln p if the cells are there, and if they are
  /// not, each less `mixed`; of ln p of the mixture, or if the cells are not there where nothing is
  /// mixed; and how many. Columns of share.size() entries.
  struct Sums {
    double* near = nullptr;
    double* far = nullptr;
    double* mixed = nullptr;
    double* beams = nullptr;
    double* near_power = nullptr;  ///< working memory: of 2, beside `near`
    double* mixed_power = nullptr;
    static constexpr std::size_t kColumns = 6;
  };
  [[nodiscard]] const Sums& sums() const { return sums_; }

 private:
  std::vector<SingleRow> row_;
  std::vector<double> from_m_, to_m_, hidden_, range_m_;
  SingleRows rows_;
  std::vector<double> near_;  // likelihoods
  std::vector<double> sum_columns_;
  Sums sums_;
};

template <typename Take>
void SingleBeams::take_multiple(Take&& take) {
  std::size_t end = 0;
  for (std::size_t first = 0; first < rows_.count; first = end) {
    end = first + 1;
    while (end < rows_.count && row(end).beam == row(first).beam &&
           row(end).fan == row(first).fan) {
      ++end;
    }
    if (end - first == 1) continue;
    for (std::size_t lane = 0; lane < RayFans::kVector; ++lane) {
      std::size_t met = 0;
      for (std::size_t n = first; n < end; ++n) met += std::isfinite(range_m(n)[lane]) ? 1 : 0;
      if (met < 2) continue;
      take(row(first).beam, row(first).fan + lane, first, end - first, lane);
      for (std::size_t n = first; n < end; ++n) {
        range_m_[n * RayFans::kVector + lane] = std::numeric_limits<double>::infinity();
      }
    }
  }
}

}  // namespace strata::localization
