// SPDX-License-Identifier: Apache-2.0
#include "core/volume/stored_columns.hpp"

#include <algorithm>
#include <limits>
#include <vector>

namespace strata::volume {
namespace {

/// Voxels above each other that make a wall, or show that there is none: a floor is one or two.
constexpr int kUpright = 3;

/// Larger cubes hold no walls, and a damaged tree may be one of them as a whole.
constexpr std::int32_t kWidest = 256;

void count(std::uint8_t& voxels, std::int32_t more) {
  constexpr std::int32_t kMost = std::numeric_limits<std::uint8_t>::max();
  voxels = static_cast<std::uint8_t>(std::min(kMost, std::int32_t{voxels} + more));
}

}  // namespace

StoredColumns::StoredColumns(const VolumeMap& map)
    : lattice_(map.lattice()), columns_(map.lattice().resolution_m()) {
  CellRect rect;
  const auto rect_of = [](const VoxelCube& cube) {
    return CellRect{{cube.corner.x, cube.corner.y},
                    {cube.corner.x + cube.edge, cube.corner.y + cube.edge}};
  };
  map.for_each_cube([&](const VoxelCube& cube) {
    if (cube.edge <= kWidest) rect = rect.united(rect_of(cube));
  });
  columns_.cover(rect);
  map.for_each_cube([&](const VoxelCube& cube) {
    if (cube.edge > kWidest) return;
    for (std::int32_t y = 0; y < cube.edge; ++y) {
      for (std::int32_t x = 0; x < cube.edge; ++x) {
        Column& column = columns_.at({cube.corner.x + x, cube.corner.y + y});
        count(cube.is_occupied ? column.occupied : column.free, cube.edge);
      }
    }
  });
}

bool StoredColumns::is_by_a_wall(const Cell& column) const {
  for (int y = -1; y <= 1; ++y) {
    for (int x = -1; x <= 1; ++x) {
      if (columns_.get({column.x + x, column.y + y}).occupied >= kUpright) return true;
    }
  }
  return false;
}

FrameLook StoredColumns::agreement(const Cloud& cloud) const {
  std::vector<VoxelKey> keys;
  const std::vector<CloudPart> parts = parts_of(cloud);
  for (std::size_t p = 0; p < parts.size(); ++p) {
    for (std::size_t i = parts[p].begin; i < end_of_part(cloud, parts, p); ++i) {
      const Eigen::Vector3d point_m = parts[p].map_from_sensor * cloud.points_m[i].cast<double>();
      const auto key = lattice_.key_at(point_m.cast<float>());
      if (key) keys.push_back(*key);
    }
  }
  std::sort(keys.begin(), keys.end());  // by column
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  FrameLook result;
  for (auto begin = keys.begin(); begin != keys.end();) {
    const auto end = std::find_if(begin, keys.end(), [&](const VoxelKey& key) {
      return key.x != begin->x || key.y != begin->y;
    });
    const Cell column{begin->x, begin->y};
    const bool is_upright = end - begin >= kUpright;
    begin = end;
    if (!is_upright) continue;
    const bool is_wall = is_by_a_wall(column);
    const bool is_known = is_wall || columns_.get(column).free >= kUpright;
    result.judged += is_known ? 1 : 0;
    result.agreed += is_wall ? 1 : 0;
  }
  return result;
}

}  // namespace strata::volume
