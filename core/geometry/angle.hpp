// SPDX-License-Identifier: Apache-2.0
/// Angles in radians on the circle.
#pragma once

#include <cmath>
#include <numbers>

namespace strata {

/// The same direction in (-pi, pi]. NaN and infinity give NaN.
[[nodiscard]] inline double wrap_angle(double angle_rad) {
  constexpr double kTwoPi = 2.0 * std::numbers::pi;
  if (angle_rad > -std::numbers::pi && angle_rad <= std::numbers::pi) return angle_rad;
  const double wrapped = angle_rad - kTwoPi * std::ceil((angle_rad - std::numbers::pi) / kTwoPi);
  // The product rounds; one step back keeps the half-open interval.
  if (wrapped <= -std::numbers::pi) return wrapped + kTwoPi;
  if (wrapped > std::numbers::pi) return wrapped - kTwoPi;
  return wrapped;
}

/// The turn from b to a, in (-pi, pi].
[[nodiscard]] inline double angle_difference(double a_rad, double b_rad) {
  return wrap_angle(a_rad - b_rad);
}

[[nodiscard]] constexpr double degrees_to_radians(double degrees) {
  return degrees * (std::numbers::pi / 180.0);
}
[[nodiscard]] constexpr double radians_to_degrees(double radians) {
  return radians * (180.0 / std::numbers::pi);
}

}  // namespace strata
