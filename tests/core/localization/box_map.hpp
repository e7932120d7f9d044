// SPDX-License-Identifier: Apache-2.0
/// A room with one changeable place: a box stands there, or does not.
#pragma once

#include <initializer_list>
#include <memory>

#include "core/patch/patch_map.hpp"
#include "tests/core/localization/box_world.hpp"

namespace strata::test {

inline const CellRect kRect{{0, 0}, {200, 80}};  // 10 m x 4 m

inline BoxWorld room() {
  return {{0.0, 0.0, 10.0, 0.3}, {0.0, 3.7, 10.0, 4.0}, {0.0, 0.0, 0.3, 4.0},
          {9.7, 0.0, 10.0, 4.0}, {2.0, 0.3, 2.6, 1.0},  {7.0, 3.2, 7.8, 3.7}};
}
inline BoxWorld room_with_box() {
  BoxWorld world = room();
  world.push_back({4.5, 0.3, 5.1, 0.9});
  return world;
}

inline patch::Submap submap_of(int id, const CellRect& rect,
                               std::initializer_list<BoxWorld> worlds) {
  patch::Submap submap;
  submap.id = id;
  submap.rect = rect;
  for (const BoxWorld& world : worlds) {
    patch::Configuration configuration;
    configuration.reflection = rasterize(world, 0.05, kRect).cropped(rect);
    configuration.prior = 1.0 / static_cast<double>(worlds.size());
    submap.configurations.push_back(configuration);
  }
  return submap;
}

inline std::shared_ptr<patch::PatchMap> empty_map() {
  auto map = std::make_shared<patch::PatchMap>();
  map->base = rasterize(room(), 0.05, kRect);
  return map;
}
/// One sub-map in the middle: without and with a box.
inline std::shared_ptr<patch::PatchMap> box_map() {
  auto map = empty_map();
  map->submaps.push_back(submap_of(0, {{80, 0}, {112, 40}}, {room(), room_with_box()}));
  return map;
}

}  // namespace strata::test
