// SPDX-License-Identifier: Apache-2.0
/// The slow, plain way to say how much of a segment lies in each cell, for comparison.
#pragma once

#include <algorithm>
#include <map>

#include "core/grid/grid.hpp"

namespace strata::test {

/// Length of a segment inside each cell of its bounding box, by clipping it against every cell in
/// extended precision. A segment that runs along a lattice line belongs to the cells above or right
/// of it, as half-open cells say.
inline std::map<Cell, double> clip_lengths(const Eigen::Vector2d& from_m,
                                           const Eigen::Vector2d& to_m, double resolution_m) {
  const Cell a = cell_at(from_m, resolution_m);
  const Cell b = cell_at(to_m, resolution_m);
  const auto resolution = static_cast<long double>(resolution_m);
  const long double u = static_cast<long double>(from_m.x()) / resolution;
  const long double v = static_cast<long double>(from_m.y()) / resolution;
  const long double du = static_cast<long double>(to_m.x()) / resolution - u;
  const long double dv = static_cast<long double>(to_m.y()) / resolution - v;
  const long double length = std::sqrt(du * du + dv * dv) * resolution;
  auto clip = [](long double start, long double along, int low, long double& t0, long double& t1) {
    if (along == 0.0L) return;  // the bounding box is one cell wide here
    const long double p = (low - start) / along;
    const long double q = (low + 1 - start) / along;
    t0 = std::max(t0, std::min(p, q));
    t1 = std::min(t1, std::max(p, q));
  };
  std::map<Cell, double> lengths;
  for (int x = std::min(a.x, b.x); x <= std::max(a.x, b.x); ++x) {
    long double x0 = 0.0L;
    long double x1 = 1.0L;
    clip(u, du, x, x0, x1);
    for (int y = std::min(a.y, b.y); y <= std::max(a.y, b.y); ++y) {
      long double t0 = x0;
      long double t1 = x1;
      clip(v, dv, y, t0, t1);
      if (t1 > t0) lengths[{x, y}] = static_cast<double>((t1 - t0) * length);
    }
  }
  return lengths;
}

}  // namespace strata::test
