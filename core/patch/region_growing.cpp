// SPDX-License-Identifier: Apache-2.0
#include "core/patch/region_growing.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <queue>
#include <tuple>
#include <utility>

#include "core/grid/connected_cells.hpp"
#include "core/grid/disc.hpp"
#include "core/grid/ray_traversal.hpp"

namespace strata::patch {
namespace {

int to_cells(double length_m, double resolution_m) {
  return static_cast<int>(std::ceil(length_m / resolution_m - 1e-9));
}

double area_m2(const CellRect& rect, double resolution_m) {
  return static_cast<double>(rect.area()) * resolution_m * resolution_m;
}

/// Distance between the nearest points of two rectangles; 0 when they overlap.
double gap_m(const CellRect& a, const CellRect& b, double resolution_m) {
  const int dx = std::max({0, a.min.x - b.max.x, b.min.x - a.max.x});
  const int dy = std::max({0, a.min.y - b.max.y, b.min.y - a.max.y});
  return resolution_m * std::hypot(dx, dy);
}

CellRect bounds(const std::vector<Cell>& cells) {
  CellRect rect;
  for (const Cell& cell : cells) rect = rect.united({cell, {cell.x + 1, cell.y + 1}});
  return rect;
}

void sort_cells(std::vector<Cell>& cells) {
  std::sort(cells.begin(), cells.end(),
            [](const Cell& a, const Cell& b) { return std::tie(a.y, a.x) < std::tie(b.y, b.x); });
}

void sort_regions(std::vector<Region>& regions) {
  std::sort(regions.begin(), regions.end(), [](const Region& a, const Region& b) {
    return std::tie(a.rect.min.y, a.rect.min.x, a.rect.max.y, a.rect.max.x) <
           std::tie(b.rect.min.y, b.rect.min.x, b.rect.max.y, b.rect.max.x);
  });
}

Region make_region(std::vector<Cell> cells, double resolution_m, const RegionConfig& config) {
  Region region;
  sort_cells(cells);
  region.rect = bounds(cells).inflated(to_cells(config.margin_m, resolution_m));
  region.cells = std::move(cells);
  return region;
}

Grid<std::uint8_t> dilated(const Grid<std::uint8_t>& mask, double radius_m) {
  const std::vector<Cell> around = disc(radius_m, mask.resolution_m());
  const int reach = around.back().y;
  Grid<std::uint8_t> result(mask.resolution_m(), mask.rect().inflated(reach), 0);
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (mask.values()[i] == 0) continue;
    const Cell cell = mask.cell(i);
    for (const Cell& offset : around) result.at({cell.x + offset.x, cell.y + offset.y}) = 1;
  }
  return result;
}

/// Possible merge of two regions that were alive when it was pushed.
struct Merge {
  double area_m2 = 0.0;
  std::size_t a = 0;
  std::size_t b = 0;
  /// For a queue with the smallest area on top; ties by index, so that order is reproducible.
  bool operator<(const Merge& other) const {
    return std::tie(area_m2, a, b) > std::tie(other.area_m2, other.a, other.b);
  }
};

}  // namespace

std::vector<Region> grow_regions(const Grid<std::uint8_t>& contradictory,
                                 const RegionConfig& config) {
  std::vector<Region> regions;
  for_each_component(
      dilated(contradictory, config.dilation_m), CellLink::kNeighbours,
      [&](std::vector<Cell> cells) {
        std::erase_if(cells, [&](const Cell& cell) { return contradictory.get(cell) == 0; });
        regions.push_back(make_region(std::move(cells), contradictory.resolution_m(), config));
        regions.back().oversized =
            area_m2(regions.back().rect, contradictory.resolution_m()) > config.max_area_m2;
      });
  return regions;
}

bool see_each_other(const Region& a, const Region& b, const ReflectionGrid& static_map,
                    const Grid<std::uint8_t>& transparent, const RegionConfig& config) {
  const std::size_t pairs = a.cells.size() * b.cells.size();
  const std::size_t samples = std::min(pairs, static_cast<std::size_t>(config.visibility_samples));
  std::size_t visible = 0;
  for (std::size_t s = 0; s < samples; ++s) {
    // Evenly over the pairs, both indices moving.
    const Cell from = a.cells[s * a.cells.size() / samples];
    const Cell to = b.cells[(s * 7919) % b.cells.size()];
    bool blocked = false;
    traverse_ray(static_map.center(from), static_map.center(to), static_map.resolution_m(),
                 [&](const Cell& cell, double) {
                   blocked = transparent.get(cell) == 0 && is_occupied(static_map.get(cell));
                   return !blocked;
                 });
    if (!blocked) ++visible;
  }
  return samples > 0 &&
         static_cast<double>(visible) >= config.min_visible_share * static_cast<double>(samples);
}

std::vector<Region> merge_regions(std::vector<Region> regions, const ReflectionGrid& static_map,
                                  const RegionConfig& config) {
  const double resolution = static_map.resolution_m();
  CellRect all;
  for (const Region& region : regions) all = all.united(region.rect);
  Grid<std::uint8_t> own(resolution, all, 0);
  for (const Region& region : regions) {
    for (const Cell& cell : region.cells) own.at(cell) = 1;
  }
  // Surfaces spread over neighbouring cells, so the neighbours of a region's cells are its own too.
  const Grid<std::uint8_t> transparent = dilated(own, 2.0 * resolution);
  std::vector<CellRect> bounding;
  for (const Region& region : regions) bounding.push_back(bounds(region.cells));
  std::vector<std::uint8_t> alive(regions.size(), 1);
  std::priority_queue<Merge> queue;
  const auto consider = [&](std::size_t a, std::size_t b) {
    const double area = area_m2(regions[a].rect.united(regions[b].rect), resolution);
    if (area > config.max_area_m2) return;
    if (gap_m(bounding[a], bounding[b], resolution) > config.max_gap_m) return;
    if (!see_each_other(regions[a], regions[b], static_map, transparent, config)) return;
    queue.push({area, a, b});
  };
  for (std::size_t a = 0; a < regions.size(); ++a) {
    for (std::size_t b = a + 1; b < regions.size(); ++b) consider(a, b);
  }
  while (!queue.empty()) {
    const Merge merge = queue.top();
    queue.pop();
    if (alive[merge.a] == 0 || alive[merge.b] == 0) continue;
    alive[merge.a] = alive[merge.b] = 0;
    std::vector<Cell> cells = std::move(regions[merge.a].cells);
    cells.insert(cells.end(), regions[merge.b].cells.begin(), regions[merge.b].cells.end());
    bounding.push_back(bounding[merge.a].united(bounding[merge.b]));
    regions.push_back(make_region(std::move(cells), resolution, config));
    alive.push_back(1);
    for (std::size_t i = 0; i + 1 < regions.size(); ++i) {
      if (alive[i] != 0) consider(i, regions.size() - 1);
    }
  }
  std::vector<Region> result;
  for (std::size_t i = 0; i < regions.size(); ++i) {
    if (alive[i] != 0) result.push_back(std::move(regions[i]));
  }
  sort_regions(result);
  return result;
}

std::vector<Region> group_by_places(std::vector<Region> regions, double resolution_m,
                                    const RegionConfig& config) {
  std::map<std::size_t, std::vector<Cell>> cells_of;  // by place
  for (Region& region : regions) {
    const CellRect rect = bounds(region.cells);
    const double x_m = 0.5 * resolution_m * (rect.min.x + rect.max.x);
    const double y_m = 0.5 * resolution_m * (rect.min.y + rect.max.y);
    std::size_t nearest = 0;
    double nearest_m = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i + 1 < config.places.size(); i += 2) {
      const double distance_m = std::hypot(config.places[i] - x_m, config.places[i + 1] - y_m);
      if (distance_m >= nearest_m) continue;
      nearest_m = distance_m;
      nearest = i;
    }
    std::vector<Cell>& cells = cells_of[nearest];
    cells.insert(cells.end(), region.cells.begin(), region.cells.end());
  }
  std::vector<Region> result;
  for (auto& [place, cells] : cells_of) {
    result.push_back(make_region(std::move(cells), resolution_m, config));
  }
  sort_regions(result);
  return result;
}

std::vector<Region> join_regions(std::vector<Region> regions, const ReflectionGrid& static_map,
                                 const RegionConfig& config) {
  return config.places.empty()
             ? merge_regions(std::move(regions), static_map, config)
             : group_by_places(std::move(regions), static_map.resolution_m(), config);
}

}  // namespace strata::patch
