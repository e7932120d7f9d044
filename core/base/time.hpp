// SPDX-License-Identifier: Apache-2.0
/// Stamps and durations at wire precision: whole nanoseconds, as ROS 2 carries them.
#pragma once

#include <cmath>
#include <compare>
#include <cstdint>

namespace strata {

/// A span of time in nanoseconds; may be negative.
struct Duration {
  std::int64_t ns = 0;

  [[nodiscard]] static Duration from_seconds(double seconds) {
    return {static_cast<std::int64_t>(std::llround(seconds * 1e9))};
  }
  [[nodiscard]] constexpr double seconds() const { return static_cast<double>(ns) * 1e-9; }
  friend constexpr auto operator<=>(const Duration&, const Duration&) = default;
  friend constexpr Duration operator+(Duration a, Duration b) { return {a.ns + b.ns}; }
  friend constexpr Duration operator-(Duration a, Duration b) { return {a.ns - b.ns}; }
};

/// A point in time in nanoseconds since an epoch that the log chooses. Stamps are per run: those of
/// two runs may overlap, so a run id goes with everything stored.
struct Stamp {
  std::int64_t ns = 0;

  [[nodiscard]] static Stamp from_seconds(double seconds) {
    return {static_cast<std::int64_t>(std::llround(seconds * 1e9))};
  }
  [[nodiscard]] constexpr double seconds() const { return static_cast<double>(ns) * 1e-9; }
  friend constexpr auto operator<=>(const Stamp&, const Stamp&) = default;
  friend constexpr Duration operator-(Stamp a, Stamp b) { return {a.ns - b.ns}; }
  friend constexpr Stamp operator+(Stamp a, Duration d) { return {a.ns + d.ns}; }
  friend constexpr Stamp operator-(Stamp a, Duration d) { return {a.ns - d.ns}; }
};

}  // namespace strata
