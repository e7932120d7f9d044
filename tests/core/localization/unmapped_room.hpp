// SPDX-License-Identifier: Apache-2.0
/// A corridor that was mapped, and beside it a room that was not.
#pragma once

#include <memory>
#include <vector>

#include "core/localization/likelihood_field_model.hpp"
#include "core/localization/range_provider_model.hpp"
#include "core/patch_beams/patch_beam_model.hpp"
#include "tests/core/localization/box_world.hpp"

namespace strata::localization::unmapped_room {

/// A corridor of 16 m x 2 m with pillars, and beside it a room that is entered by a gap at x = 8 to
/// 9 m; the wall between them is 0.3 m thick.
inline test::BoxWorld building() {
  return {{0.0, -0.3, 16.0, 0.0},
          {-0.3, -0.3, 0.0, 2.3},
          {16.0, -0.3, 16.3, 2.3},
          {0.0, 2.0, 8.0, 2.3},
          {9.0, 2.0, 16.0, 2.3},
          {3.0, 0.0, 3.4, 0.5},
          {5.6, 1.6, 6.0, 2.0},
          {11.0, 0.0, 11.3, 0.6},
          {13.0, 1.5, 13.5, 2.0},
          // The room.
          {4.7, 2.0, 5.0, 8.0},
          {12.0, 2.0, 12.3, 8.0},
          {4.7, 8.0, 12.3, 8.3},
          {6.0, 5.0, 6.8, 6.0},
          {10.0, 4.0, 10.5, 5.5}};
}

inline constexpr double kInnerWall_m = 2.05;

/// What was seen from the corridor only: it, and the first cell of every wall.
inline ReflectionGrid corridor_map() {
  ReflectionGrid map = test::rasterize(building(), 0.05, {{-6, -6}, {326, 166}});
  for (std::size_t i = 0; i < map.size(); ++i) {
    const Eigen::Vector2d at = map.center(map.cell(i));
    const bool is_seen =
        at.x() > -0.05 && at.x() < 16.05 && at.y() > -0.05 && at.y() < kInnerWall_m;
    if (!is_seen) map.values()[i] = kUnknownReflection;
  }
  return map;
}

inline std::shared_ptr<const patch::PatchMap> as_patch_map() {
  auto map = std::make_shared<patch::PatchMap>();
  map->base = corridor_map();
  return map;
}

inline std::vector<std::shared_ptr<const SensorModel>> models() {
  return {make_grid_beam_model(corridor_map()),
          std::make_shared<const patch_beams::PatchBeamModel>(as_patch_map()),
          std::make_shared<const LikelihoodFieldModel>(corridor_map())};
}

}  // namespace strata::localization::unmapped_room
