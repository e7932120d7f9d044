// SPDX-License-Identifier: Apache-2.0
/// Functions of nothing but sums, products and quotients: the same bits on every machine, which
/// libraries of mathematics do not promise. For codes that two machines must read alike.
#pragma once

#include <cmath>

namespace strata::memory::detail {

/// Within 1e-13. Requires a positive finite number.
[[nodiscard]] inline double plain_ln(double x) {
  constexpr double kLn2 = 0.693147180559945309;
  int exponent = 0;
  double m = std::frexp(x, &exponent);
  if (m < 0.70710678) {
    m *= 2.0;
    --exponent;
  }
  const double t = (m - 1.0) / (m + 1.0);
  double sum = 0.0;
  for (int k = 19; k >= 1; k -= 2) sum = sum * t * t + 1.0 / k;
  return exponent * kLn2 + 2.0 * t * sum;
}

/// Within a few units of the 15th digit. Requires |x| < 700.
[[nodiscard]] inline double plain_exp(double x) {
  constexpr double kLn2 = 0.693147180559945309;
  const double k = std::floor(x / kLn2 + 0.5);
  const double r = x - k * kLn2;
  double sum = 1.0;
  for (int n = 13; n >= 1; --n) sum = 1.0 + sum * r / n;
  return std::ldexp(sum, static_cast<int>(k));
}

struct PlainDirection {
  double cosine = 1.0;
  double sine = 0.0;
};

/// Cosine and sine, within 1e-12. Requires |angle_rad| < 1e6.
[[nodiscard]] inline PlainDirection plain_direction(double angle_rad) {
  constexpr double kHalfPi = 1.57079632679489661923;
  const double quarters = std::floor(angle_rad / kHalfPi + 0.5);
  const double r = angle_rad - quarters * kHalfPi;
  double sine = 0.0;
  double cosine = 0.0;
  for (int n = 17; n >= 1; n -= 2) sine = 1.0 - sine * r * r / ((n + 1.0) * (n + 2.0));
  sine *= r;
  for (int n = 16; n >= 0; n -= 2) cosine = 1.0 - cosine * r * r / ((n + 1.0) * (n + 2.0));
  switch (static_cast<long long>(quarters) & 3) {
    case 0:
      return {cosine, sine};
    case 1:
      return {-sine, cosine};
    case 2:
      return {-cosine, -sine};
    default:
      return {sine, -cosine};
  }
}

}  // namespace strata::memory::detail
