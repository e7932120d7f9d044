// SPDX-License-Identifier: Apache-2.0
/// How much of a scan a map explains from one pose, and how much it says nothing of.
#pragma once

#include <concepts>

#include <Eigen/Core>

namespace strata::localization {

/// Shares of the beams in use. A beam is not judged when it may end where the map knows nothing and
/// meets no mapped obstacle on its way, nor when nothing returns to a laser in a place that the map
/// does not know: neither the pose nor the map is wrong for that. In space that was never mapped a
/// right pose would otherwise be called lost. 0 <= explained <= judged <= 1; both are 0 when no
/// beam speaks.
struct Explanation {
  double explained = 0.0;  ///< end where the map expects it
  double judged = 0.0;  ///< ... or elsewhere, though the map knows that place or what lies before
};

/// Whatever says where it knows anything.
template <typename T>
concept LimitedMap = requires(const T& map, const Eigen::Vector2d& point_m) {
  { map.knows(point_m) } -> std::convertible_to<bool>;
};

/// Whether a map knows the place where a beam ends, and four more up to `tolerance_m` behind it: an
/// obstacle there would still explain the beam. Points in the map frame [m].
template <LimitedMap Map>
[[nodiscard]] bool knows_end(const Map& map, const Eigen::Vector2d& laser_m,
                             const Eigen::Vector2d& end_m, double tolerance_m) {
  constexpr int kSteps = 4;
  const double range_m = (end_m - laser_m).norm();
  const double step = range_m > 0.0 ? tolerance_m / (kSteps * range_m) : 0.0;
  for (int n = 0; n <= kSteps; ++n) {
    if (!map.knows(end_m + n * step * (end_m - laser_m))) return false;
  }
  return true;
}

}  // namespace strata::localization
