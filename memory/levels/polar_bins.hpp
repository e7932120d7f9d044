// SPDX-License-Identifier: Apache-2.0
/// How a node divides the plane around it into angle and range bins [kessler2010what, figure 3].
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace strata::memory {

/// Angle bin a covers bearings [a, a + 1) * 2 pi / angle_bins of the map frame, seen from the node;
/// range bin i covers [i, i + 1) * range_bin_m(). One more range bin, the overflow bin, holds "at
/// least max_range_m": the paper has none, and so can never forget an obstacle that vanishes before
/// open space. Nor one that vanishes where the scanner does not reach what is behind it: what is
/// only known to be no nearer than f, f < max_range_m, is -f wherever ranges of a node are kept.
struct PolarBins {
  int angle_bins = 360;
  int range_bins = 50;  ///< without the overflow bin; at most kMaxRangeBins
  double max_range_m = 8.0;

  static constexpr int kMaxRangeBins = 254;

  friend bool operator==(const PolarBins&, const PolarBins&) = default;
  [[nodiscard]] double range_bin_m() const { return max_range_m / range_bins; }
  [[nodiscard]] double angle_bin_rad() const { return 2.0 * std::numbers::pi / angle_bins; }
  [[nodiscard]] double center_bearing_rad(int angle_bin) const {
    return (angle_bin + 0.5) * angle_bin_rad();
  }
  [[nodiscard]] int overflow_bin() const { return range_bins; }
  /// What stands for -f in pairs of range bins; no neighbour of another bin.
  [[nodiscard]] int beyond_bin() const { return range_bins + 2; }
  /// With more range bins there is no number left for it.
  [[nodiscard]] bool tells_beyond() const { return range_bins <= 252; }
  /// The angle bin after this one, around the circle.
  [[nodiscard]] int next(int angle_bin) const {
    return angle_bin + 1 == angle_bins ? 0 : angle_bin + 1;
  }
  /// Requires range_m not NaN and not negative.
  [[nodiscard]] std::uint8_t range_bin(float range_m) const {
    const double range = static_cast<double>(range_m);
    if (!(range < max_range_m)) return static_cast<std::uint8_t>(overflow_bin());
    // Rounding of the quotient may reach range_bins for a range a hair below max_range_m.
    return static_cast<std::uint8_t>(
        std::min(range_bins - 1, static_cast<int>(range / range_bin_m())));
  }
  /// range_bin, or beyond_bin for what is only known to be no nearer than that.
  [[nodiscard]] std::uint8_t state_bin(float range_m) const {
    return range_m < 0.0F ? static_cast<std::uint8_t>(beyond_bin()) : range_bin(range_m);
  }
};

}  // namespace strata::memory
