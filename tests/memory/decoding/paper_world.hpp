// SPDX-License-Identifier: Apache-2.0
/// The world of the experiments of [kessler2010what, section 5]: one node, 360 bins of 1 degree, 20
/// range bins of 7.5 cm.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "core/random/stream.hpp"
#include "memory/levels/polar_bins.hpp"
#include "memory/levels/virtual_scan.hpp"

namespace strata::memory::paper_world {

inline const PolarBins kBins{360, 20, 1.5};
inline constexpr int kSamples = 20;
inline constexpr std::size_t kObjectBegin = 100;
inline constexpr std::size_t kObjectEnd = 150;
inline constexpr double kNoise_m = 0.03;

/// A wall whose distance varies along the bins, so that some ranges straddle range bins; the object
/// stands 0.45 m in front of it.
inline double wall_m(std::size_t a) {
  return 1.15 + 0.15 * std::sin(0.05 * static_cast<double>(a));
}
inline double range_m(std::size_t a, bool with_object) {
  const bool in_object = a >= kObjectBegin && a < kObjectEnd;
  return wall_m(a) - (with_object && in_object ? 0.45 : 0.0);
}

inline VirtualScan measure(bool with_object, RandomStream& random) {
  VirtualScan scan;
  for (std::size_t a = 0; a < 360; ++a) {
    scan.push_back(static_cast<float>(range_m(a, with_object) + random.normal(0.0, kNoise_m)));
  }
  return scan;
}

inline bool shows_object(const std::vector<float>& scan, std::size_t a) {
  return static_cast<double>(scan[a]) < wall_m(a) - 0.225;
}

/// Share of the bins [begin, end) that show the object.
inline double share_with_object(const std::vector<float>& scan, std::size_t begin,
                                std::size_t end) {
  double count = 0.0;
  for (std::size_t a = begin; a < end; ++a) count += shows_object(scan, a) ? 1.0 : 0.0;
  return count / static_cast<double>(end - begin);
}

/// What a scan shows when the robot believes to be somewhere else: a room of 2 by 2 m.
inline double room_m(double x, double y, double angle) {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  return std::min(std::abs(((c > 0.0 ? 1.0 : -1.0) - x) / c),
                  std::abs(((s > 0.0 ? 1.0 : -1.0) - y) / s));
}

/// A scan from the middle of that room, or one that the robot takes for such.
inline VirtualScan measure_room(bool mislocalized, RandomStream& random) {
  VirtualScan scan;
  for (int a = 0; a < 360; ++a) {
    const double angle = kBins.center_bearing_rad(a);
    const double range = mislocalized ? room_m(-0.3, 0.2, angle + 0.1) : room_m(0.0, 0.0, angle);
    scan.push_back(static_cast<float>(range + random.normal(0.0, kNoise_m)));
  }
  return scan;
}
/// Share of bins that are off by more than 0.15 m.
inline double wrong_share(const std::vector<float>& range_m) {
  int bad = 0;
  for (int a = 0; a < 360; ++a) {
    const double error = static_cast<double>(range_m[static_cast<std::size_t>(a)]) -
                         room_m(0.0, 0.0, kBins.center_bearing_rad(a));
    bad += std::abs(error) > 0.15 ? 1 : 0;
  }
  return bad / 360.0;
}

}  // namespace strata::memory::paper_world
