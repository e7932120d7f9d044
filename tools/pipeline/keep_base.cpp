// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/keep_base.hpp"

#include <algorithm>
#include <tuple>

#include "components/maps/maps_folder.hpp"
#include "core/base/error.hpp"
#include "core/grid/blind_beams.hpp"
#include "memory/store/store.hpp"

namespace strata::pipeline {
namespace {

constexpr std::size_t kMaxRegionCells = 40'000'000;

/// limits.never, and all that is not in limits.only, as far as anything is known.
Grid<std::uint8_t> never_cells(const LearnWithin& limits, const slam::SlamResult& slam) {
  const Grid<std::uint8_t>& only = limits.only;
  if (only.rect().empty()) return limits.never;
  CellRect rect = only.rect().united(slam.occupancy.rect()).united(slam.filtered.rect());
  rect = rect.united(limits.before.occupancy.rect()).united(limits.before.counts.rect());
  Grid<std::uint8_t> never(only.resolution_m(), rect.united(limits.never.rect()), 1);
  for (std::size_t i = 0; i < only.size(); ++i) {
    const Cell cell = only.cell(i);
    if (only.values()[i] != 0 && limits.never.get(cell) == 0) never.at(cell) = 0;
  }
  return never;
}

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

Grid<std::uint8_t> cells_of_region(const std::vector<MetricPolygon>& region, double resolution_m,
                                   const std::string& place) {
  CellRect rect;
  for (const MetricPolygon& polygon : region) {
    rect = rect.united(cells_around(polygon, resolution_m));
  }
  if (rect.area() > kMaxRegionCells) {
    throw InputError(place, "is larger than 40 million cells", "draw what is meant alone");
  }
  Grid<std::uint8_t> cells(resolution_m, rect, 0);
  bool has_some = false;
  for (const MetricPolygon& polygon : region) {
    const Grid<std::uint8_t> inside = cells_in(polygon, resolution_m, rect);
    for (std::size_t i = 0; i < inside.size(); ++i) {
      if (inside.values()[i] == 0) continue;
      cells.at(inside.cell(i)) = 1;
      has_some = true;
    }
  }
  if (!has_some) throw InputError(place, "holds the middle of no cell", "draw it larger");
  return cells;
}

BaseBefore read_base(const std::filesystem::path& maps) {
  const memory::Store store = maps::open_for_reading(maps);
  return {store.load_reflection_grid("occupancy"), store.load_reflection_grid("filtered"),
          store.load_counts_grid("counts"), store.load_surfaces("filtered")};
}

void require_same_cells(const LearnWithin& limits, double resolution_m) {
  const ReflectionGrid& before = limits.before.occupancy;
  if (before.rect().empty() || before.resolution_m() == resolution_m) return;
  throw InputError("slam.beam_filter.resolution_m",
                   "is " + std::to_string(resolution_m) + " m, and the maps before have cells of " +
                       std::to_string(before.resolution_m()) + " m",
                   "set it to theirs");
}

void keep_base(const LearnWithin& limits, int first_run, slam::SlamResult& slam) {
  const Grid<std::uint8_t> never = never_cells(limits, slam);
  if (never.rect().empty()) return;
  for (PosedScan& scan : slam.scans) {
    if (scan.run >= first_run) (void)blind_beams(scan, never);
  }
  const auto before = [](const ReflectionGrid& grid, const Cell& cell) {
    return grid.contains(cell) ? grid.at(cell) : kUnknownReflection;
  };
  if (limits.forgets) {  // then new maps may reach less far
    slam.occupancy.grow(limits.before.occupancy.rect());
    slam.filtered.grow(limits.before.filtered.rect());
    slam.raw.cells().grow(limits.before.counts.rect());
  }
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
