// SPDX-License-Identifier: Apache-2.0
#include "core/slam/learned_surfaces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/registration/match_field.hpp"
#include "core/tracking/surface_map.hpp"

namespace strata::slam {
namespace {

std::uint8_t in_256ths(double share) {
  return static_cast<std::uint8_t>(std::clamp(std::floor(share * 256.0), 0.0, 255.0));
}

SurfaceCell packed(const registration::SurfacePoint& point, double resolution_m) {
  const Cell cell = cell_at({point.x_m, point.y_m}, resolution_m);
  const double angle = std::atan2(point.normal_y, point.normal_x) / std::numbers::pi;  // -1 ... 1
  SurfaceCell surface;
  surface.x = cell.x;
  surface.y = cell.y;
  surface.offset_x = in_256ths(point.x_m / resolution_m - cell.x);
  surface.offset_y = in_256ths(point.y_m / resolution_m - cell.y);
  surface.normal = in_256ths(angle - std::floor(angle));
  surface.tangential = in_256ths(point.tangential);
  return surface;
}

}  // namespace

SurfaceLayer learned_surfaces(std::span<const PosedScan> scans, double resolution_m) {
  SurfaceMap map(resolution_m);
  for (const PosedScan& posed : scans) {
    map.add(posed.scan, posed.map_from_laser(), posed.static_probability,
            std::numeric_limits<double>::infinity(), /*carve=*/false);
  }
  SurfaceLayer layer{resolution_m, {}};
  for (const registration::SurfacePoint& point : map.surfaces()) {
    layer.cells.push_back(packed(point, resolution_m));
  }
  const auto is_before = [](const SurfaceCell& a, const SurfaceCell& b) {
    return std::pair(a.y, a.x) < std::pair(b.y, b.x);
  };
  const auto is_same = [](const SurfaceCell& a, const SurfaceCell& b) {
    return a.x == b.x && a.y == b.y;
  };
  // Rounding can put a mean that lies on an edge into the next cell, which has one of its own.
  std::stable_sort(layer.cells.begin(), layer.cells.end(), is_before);
  layer.cells.erase(std::unique(layer.cells.begin(), layer.cells.end(), is_same),
                    layer.cells.end());
  return layer;
}

}  // namespace strata::slam
