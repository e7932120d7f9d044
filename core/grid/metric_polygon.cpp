// SPDX-License-Identifier: Apache-2.0
#include "core/grid/metric_polygon.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace strata {
namespace {

/// A cell's number, within what fits beside a rectangle of cells.
int bounded(double number, int least, int greatest) {
  return static_cast<int>(
      std::clamp(number, static_cast<double>(least), static_cast<double>(greatest)));
}

double x_at(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double y_m) {
  return a.x() + (b.x() - a.x()) * ((y_m - a.y()) / (b.y() - a.y()));
}

bool crosses(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double y_m) {
  return (a.y() > y_m) != (b.y() > y_m);
}

bool contains(const MetricRing& ring, const Eigen::Vector2d& point_m) {
  bool inside = false;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Eigen::Vector2d& a = ring[i];
    const Eigen::Vector2d& b = ring[(i + 1) % ring.size()];
    if (crosses(a, b, point_m.y()) && point_m.x() < x_at(a, b, point_m.y())) inside = !inside;
  }
  return inside;
}

/// Sets the cells whose middle the ring contains: of each row, from where an edge crosses it to
/// where the next one does.
void fill(Grid<std::uint8_t>& grid, const MetricRing& ring, std::uint8_t value) {
  const CellRect& rect = grid.rect();
  const double resolution_m = grid.resolution_m();
  // Of each row the first cells right of the edges that cross it.
  std::vector<std::vector<int>> firsts(static_cast<std::size_t>(rect.height()));
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Eigen::Vector2d& a = ring[i];
    const Eigen::Vector2d& b = ring[(i + 1) % ring.size()];
    const auto [low, high] = std::minmax(a.y(), b.y());
    const int from = bounded(std::floor(low / resolution_m) - 1.0, rect.min.y, rect.max.y);
    const int to = bounded(std::floor(high / resolution_m) + 2.0, rect.min.y, rect.max.y);
    for (int y = from; y < to; ++y) {
      const double middle_m = cell_center({0, y}, resolution_m).y();
      if (!crosses(a, b, middle_m)) continue;
      const double x_m = x_at(a, b, middle_m);
      int first = bounded(std::floor(x_m / resolution_m) - 1.0, rect.min.x, rect.max.x);
      while (first < rect.max.x && cell_center({first, y}, resolution_m).x() < x_m) ++first;
      firsts[static_cast<std::size_t>(y - rect.min.y)].push_back(first);
    }
  }
  for (int y = rect.min.y; y < rect.max.y; ++y) {
    std::vector<int>& row = firsts[static_cast<std::size_t>(y - rect.min.y)];
    std::sort(row.begin(), row.end());
    for (std::size_t i = 0; i + 1 < row.size(); i += 2) {
      for (int x = row[i]; x < row[i + 1]; ++x) grid.at({x, y}) = value;
    }
  }
}

}  // namespace

double signed_area_m2(const MetricRing& ring) {
  double twice = 0.0;
  for (std::size_t i = 1; i + 1 < ring.size(); ++i) {
    const Eigen::Vector2d a = ring[i] - ring[0];
    const Eigen::Vector2d b = ring[i + 1] - ring[0];
    twice += a.x() * b.y() - b.x() * a.y();
  }
  return twice / 2.0;
}

double area_m2(const MetricPolygon& polygon) {
  double area = std::abs(signed_area_m2(polygon.outer));
  for (const MetricRing& hole : polygon.holes) area -= std::abs(signed_area_m2(hole));
  return std::max(0.0, area);
}

bool contains(const MetricPolygon& polygon, const Eigen::Vector2d& point_m) {
  return contains(polygon.outer, point_m) &&
         std::none_of(polygon.holes.begin(), polygon.holes.end(),
                      [&](const MetricRing& hole) { return contains(hole, point_m); });
}

CellRect cells_around(const MetricPolygon& polygon, double resolution_m) {
  if (polygon.outer.empty()) return {};
  Eigen::Vector2d low = polygon.outer.front();
  Eigen::Vector2d high = low;
  for (const Eigen::Vector2d& corner : polygon.outer) {
    low = low.cwiseMin(corner);
    high = high.cwiseMax(corner);
  }
  constexpr double kRounding = 1e-6;  // of a cell
  const Eigen::Vector2d first = low / resolution_m - Eigen::Vector2d::Constant(0.5 + kRounding);
  const Eigen::Vector2d last = high / resolution_m - Eigen::Vector2d::Constant(0.5 - kRounding);
  return {{static_cast<int>(std::ceil(first.x())), static_cast<int>(std::ceil(first.y()))},
          {static_cast<int>(std::floor(last.x())) + 1, static_cast<int>(std::floor(last.y())) + 1}};
}

Grid<std::uint8_t> cells_in(const MetricPolygon& polygon, double resolution_m,
                            const CellRect& rect) {
  const CellRect part = cells_around(polygon, resolution_m).intersected(rect);
  Grid<std::uint8_t> cells(resolution_m, part.empty() ? CellRect{} : part, 0);
  if (part.empty()) return cells;
  fill(cells, polygon.outer, 1);
  for (const MetricRing& hole : polygon.holes) fill(cells, hole, 0);
  return cells;
}

MetricPolygon to_metric(const CellPolygon& polygon, double resolution_m) {
  const auto ring_of = [&](const CellRing& ring) {
    MetricRing metric;
    for (const Cell& corner : ring) {
      metric.emplace_back(corner.x * resolution_m, corner.y * resolution_m);
    }
    return metric;
  };
  MetricPolygon metric{ring_of(polygon.outer), {}};
  for (const CellRing& hole : polygon.holes) metric.holes.push_back(ring_of(hole));
  return metric;
}

}  // namespace strata
