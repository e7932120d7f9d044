// SPDX-License-Identifier: Apache-2.0
#include "tools/site/often_changing.hpp"

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

namespace strata::site {
namespace {

constexpr double kSecondsInHour = 3600.0;

/// Whether the cell is a wall in one configuration and free in another.
bool changes(const patch::Submap& submap, const Cell& cell) {
  bool is_wall = false;
  bool is_open = false;
  for (const patch::Configuration& one : submap.configurations) {
    const float value = one.reflection.get(cell);
    is_wall = is_wall || is_occupied(value);
    is_open = is_open || is_free(value);
  }
  return is_wall && is_open;
}

std::vector<MetricPolygon> shape_of(const patch::Submap& submap, double resolution_m) {
  std::set<Cell> cells;
  for (int y = submap.rect.min.y; y < submap.rect.max.y; ++y) {
    for (int x = submap.rect.min.x; x < submap.rect.max.x; ++x) {
      if (!changes(submap, {x, y})) continue;
      (void)any_beside(Cell{x, y}, [&](const Cell& beside) {
        cells.insert(beside);
        return false;
      });
    }
  }
  std::vector<MetricPolygon> shape;
  for (const CellPolygon& polygon : outline({cells.begin(), cells.end()})) {
    shape.push_back(to_metric(polygon, resolution_m));
  }
  return shape;
}

}  // namespace

Zones often_changing(const patch::PatchMap& map, const std::string& frame) {
  std::vector<std::pair<double, Zones::Document>> found;
  for (const patch::Submap& submap : map.submaps) {
    const std::vector<MetricPolygon> shape = shape_of(submap, map.base.resolution_m());
    if (shape.empty()) continue;
    double area = 0.0;
    for (const MetricPolygon& polygon : shape) area += area_m2(polygon);
    const double rate = submap.change_rate_per_s * kSecondsInHour;
    Zones::Document properties{{"name", "changes " + std::to_string(submap.id)},
                               {"kind", "learn"},
                               {"control", "learn"},
                               {"changes_per_hour", rate > 0.0 ? Zones::Document(rate) : nullptr},
                               {"configurations", submap.configurations.size()},
                               {"area_m2", area}};
    found.emplace_back(rate, to_feature(shape, std::move(properties)));
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  Zones::Document features = Zones::Document::array();
  for (auto& [rate, feature] : found) features.push_back(std::move(feature));
  return zones_of(to_collection(std::move(features), frame), "places that change");
}

}  // namespace strata::site
