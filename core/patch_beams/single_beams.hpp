// SPDX-License-Identifier: Apache-2.0
/// Beams that may end at the cells of one box, all alike, or behind them: most of those that pass
/// where sub-maps change. A row of particles at a time.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "core/rays/ray_boxes.hpp"

namespace strata::patch_beams {

/// Working memory: begin(), rows(), cast(), take_multiple(); then what was found. Allocates nothing
/// once warm.
class SingleBeams {
 public:
  void begin() { rows_.count = 0; }
  /// The rows so far, with room for this many more.
  [[nodiscard]] rays::SingleRows& rows(std::size_t more);
  /// Follows all of them through their boxes. table: of changing cells.
  void cast(const rays::RayTable& table, const rays::BeamBundles& bundles);
  /// A beam met something in several boxes: calls take(beam, bundle, first row, rows, lane) for
  /// each, and leaves it out from here on. Ranges are there until take returns.
  template <typename Take>
  void take_multiple(Take&& take);

  /// Number of rows; what they are; and where the beams of one met something, +infinity: nowhere.
  [[nodiscard]] std::size_t size() const { return rows_.count; }
  [[nodiscard]] const rays::SingleRow& row(std::size_t n) const { return rows_.rows[n]; }
  [[nodiscard]] std::span<const rays::SingleRow> all_rows() const {
    return {row_.data(), rows_.count};
  }
  [[nodiscard]] const double* range_m(std::size_t n) const {
    return range_m_.data() + n * rays::BeamBundles::kVector;
  }

 private:
  std::vector<rays::SingleRow> row_;
  std::vector<double> from_m_, to_m_, hidden_, range_m_;
  rays::SingleRows rows_;
};

template <typename Take>
void SingleBeams::take_multiple(Take&& take) {
  std::size_t end = 0;
  for (std::size_t first = 0; first < rows_.count; first = end) {
    end = first + 1;
    while (end < rows_.count && row(end).beam == row(first).beam &&
           row(end).bundle == row(first).bundle) {
      ++end;
    }
    if (end - first == 1) continue;
    for (std::size_t lane = 0; lane < rays::BeamBundles::kVector; ++lane) {
      std::size_t met = 0;
      for (std::size_t n = first; n < end; ++n) met += std::isfinite(range_m(n)[lane]) ? 1 : 0;
      if (met < 2) continue;
      take(row(first).beam, row(first).bundle + lane, first, end - first, lane);
      for (std::size_t n = first; n < end; ++n) {
        range_m_[n * rays::BeamBundles::kVector + lane] = std::numeric_limits<double>::infinity();
      }
    }
  }
}

}  // namespace strata::patch_beams
