// SPDX-License-Identifier: Apache-2.0
/// A small room as learning leaves it: grids, one sub-map with two configurations, a memory.
#pragma once

#include <memory>
#include <vector>

#include "components/maps/maps_folder.hpp"
#include "tests/memory/nodes/room_world.hpp"

namespace strata::maps::test_room {

inline constexpr int kScansARun = 6;
inline constexpr double kStep_m = 0.25;

/// Two runs along y = 0.2, one scan a second, the second an hour later. The box of the room stands
/// in the second run only.
inline slam::SlamResult make_slam_result() {
  slam::SlamResult result;
  for (int run = 0; run < 2; ++run) {
    for (int i = 0; i < kScansARun; ++i) {
      const Pose2 pose{-2.0 + kStep_m * i, 0.2, 0.1 * i};
      PosedScan scan = memory::test_world::observe(pose, 3600.0 * run + i, run == 1);
      scan.run = run;
      result.raw.add(scan);
      result.scans.push_back(std::move(scan));
    }
  }
  CountingMap first_run;
  for (int i = 0; i < kScansARun; ++i) first_run.add(result.scans[static_cast<std::size_t>(i)]);
  result.occupancy = result.raw.reflection();
  result.filtered = first_run.reflection();
  result.log_likelihood = {-1234.5, -1000.25};
  result.iterations = 2;
  result.dynamic_fraction = 0.125;
  result.skipped_scans = 3;
  return result;
}

/// The box's place: free in configuration 0, taken in configuration 1.
inline patch::PatchMap make_patch_map(const slam::SlamResult& slam) {
  patch::PatchMap map;
  map.base = slam.filtered;
  patch::Submap submap;
  submap.rect = {{36, -24}, {64, 24}};  // x 1.8 to 3.2 m, y -1.2 to 1.2 m
  submap.contradictory = Grid<std::uint8_t>(map.base.resolution_m(), submap.rect, 1);
  for (int c = 0; c < 2; ++c) {
    patch::Configuration configuration;
    configuration.counts = Grid<CellCounts>(map.base.resolution_m(), submap.rect, {1.0 + c, 0.5});
    configuration.reflection = ReflectionGrid(map.base.resolution_m(), submap.rect, 0.0F);
    const CellRect box{{40, -20}, {60, 20}};
    for (int x = box.min.x; c == 1 && x < box.max.x; ++x) {
      for (int y = box.min.y; y < box.max.y; ++y) configuration.reflection.at({x, y}) = 0.9F;
    }
    configuration.prior = c == 0 ? 0.25 : 0.75;
    submap.configurations.push_back(std::move(configuration));
  }
  const Stamp begin = slam.scans.front().scan.stamp;
  const Stamp end = slam.scans.back().scan.stamp;
  submap.sequences = {{0, begin, end, 6, {0.9, 0.1}},
                      {1, begin, end, 5, {0.2, 0.8}},
                      {1, begin, end, 4, {0.3, 0.7}}};
  map.submaps.push_back(std::move(submap));
  return map;
}

inline std::shared_ptr<memory::TimescaleMemory> make_memory(const slam::SlamResult& slam) {
  auto result = std::make_shared<memory::TimescaleMemory>(memory::TimescaleConfig{}, 7);
  for (const PosedScan& scan : slam.scans) result->observe(scan);
  return result;
}

inline Maps make_maps() {
  const slam::SlamResult slam = make_slam_result();
  Maps maps;
  maps.occupancy = slam.occupancy;
  maps.filtered = slam.filtered;
  maps.patches = make_patch_map(slam);
  maps.timescale = make_memory(slam);
  const auto scans = std::make_shared<const std::vector<PosedScan>>(slam.scans);
  maps.visit_scans = [scans](const auto& visit) {
    for (const PosedScan& scan : *scans) visit(scan);
  };
  return maps;
}

}  // namespace strata::maps::test_room
