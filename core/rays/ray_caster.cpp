// SPDX-License-Identifier: Apache-2.0
#include "core/rays/ray_caster.hpp"

#include <numbers>

namespace strata::rays {

RayWalker::RayWalker(const Grid<std::uint8_t>& marked)
    : empty_skip_(marked.resolution_m(), marked.rect()) {
  const DistanceField distances = make_distance_field(marked);
  for (std::size_t i = 0; i < marked.size(); ++i) {
    if (marked.values()[i] != 0) {
      empty_skip_.values()[i] = -1.0F;
      continue;
    }
    // Half a diagonal for where the ray is in this cell, half for the marked cell's corner, and a
    // little for rounding to float.
    const double cells = static_cast<double>(distances.values()[i]) / marked.resolution_m();
    const double empty_skip = (cells - std::numbers::sqrt2) * (1.0 - 1e-6) - 1e-6;
    empty_skip_.values()[i] = static_cast<float>(std::clamp(empty_skip, 0.0, 1e6));
  }
}

RayWalker::RayWalker(const Grid<std::int32_t>& marks) {
  Grid<std::uint8_t> marked(marks.resolution_m(), marks.rect());
  for (std::size_t i = 0; i < marks.size(); ++i) marked.values()[i] = marks.values()[i] > 0 ? 1 : 0;
  *this = RayWalker(marked);
  for (std::size_t i = 0; i < marks.size(); ++i) {
    const std::int32_t mark = marks.values()[i];
    if (mark > 0) empty_skip_.values()[i] = -static_cast<float>(mark);
  }
}

RayCaster::RayCaster(const ReflectionGrid& map, double max_range_m)
    : known_(map.resolution_m(), map.rect()), max_range_m_(max_range_m) {
  for (std::size_t i = 0; i < map.size(); ++i) {
    known_.values()[i] = is_known(map.values()[i]) ? 1 : 0;
  }
  walker_ = RayWalker(occupied_cells(map));
}

double RayCaster::expected_range_m(const Pose2& map_from_laser, double bearing_rad) const {
  const double angle = map_from_laser.theta + bearing_rad;
  return range_m(map_from_laser.x, map_from_laser.y, std::cos(angle), std::sin(angle),
                 max_range_m_);
}

}  // namespace strata::rays
