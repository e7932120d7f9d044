// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/keep_base.hpp"

#include <algorithm>
#include <tuple>

#include "components/maps/maps_folder.hpp"
#include "core/grid/blind_beams.hpp"
#include "memory/store/store.hpp"

namespace strata::pipeline {
namespace {

SurfaceLayer kept(const SurfaceLayer& before, const SurfaceLayer& now,
                  const Grid<std::uint8_t>& never) {
  SurfaceLayer layer{now.resolution_m, {}};
  const auto take = [&](const SurfaceLayer& from, bool inside) {
    for (const SurfaceCell& one : from.cells) {
      if ((never.get({one.x, one.y}) != 0) == inside) layer.cells.push_back(one);
    }
  };
  take(before, true);
  take(now, false);
  std::sort(layer.cells.begin(), layer.cells.end(), [](const auto& a, const auto& b) {
    return std::tuple(a.y, a.x) < std::tuple(b.y, b.x);
  });
  return layer;
}

}  // namespace

BaseBefore read_base(const std::filesystem::path& maps) {
  const memory::Store store = maps::open_for_reading(maps);
  return {store.load_reflection_grid("occupancy"), store.load_reflection_grid("filtered"),
          store.load_counts_grid("counts"), store.load_surfaces("filtered")};
}

void keep_base(const LearnWithin& limits, int first_run, slam::SlamResult& slam) {
  const Grid<std::uint8_t>& never = limits.never;
  if (never.rect().empty()) return;
  for (PosedScan& scan : slam.scans) {
    if (scan.run >= first_run) (void)blind_beams(scan, never);
  }
  const auto before = [](const ReflectionGrid& grid, const Cell& cell) {
    return grid.contains(cell) ? grid.at(cell) : kUnknownReflection;
  };
  for (std::size_t i = 0; i < never.size(); ++i) {
    if (never.values()[i] == 0) continue;
    const Cell cell = never.cell(i);
    if (slam.occupancy.contains(cell)) {
      slam.occupancy.at(cell) = before(limits.before.occupancy, cell);
    }
    if (slam.filtered.contains(cell)) {
      slam.filtered.at(cell) = before(limits.before.filtered, cell);
    }
    if (slam.raw.cells().contains(cell)) slam.raw.cells().at(cell) = limits.before.counts.get(cell);
  }
  slam.surfaces = kept(limits.before.surfaces, slam.surfaces, never);
}

}  // namespace strata::pipeline
