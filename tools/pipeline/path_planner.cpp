// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/path_planner.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <limits>
#include <numbers>
#include <queue>
#include <utility>

#include "core/grid/distance_field.hpp"
#include "core/grid/floor_divide.hpp"

namespace strata::pipeline {
namespace {

constexpr double kCell_m = 0.1;
constexpr double kSnap_m = 0.5;

double octile(const Cell& a, const Cell& b) {
  const double dx = std::abs(a.x - b.x);
  const double dy = std::abs(a.y - b.y);
  return std::max(dx, dy) + (std::numbers::sqrt2 - 1.0) * std::min(dx, dy);
}

}  // namespace

PathPlanner::PathPlanner(const ReflectionGrid& map, double robot_radius_m) {
  const int factor = std::max(1, static_cast<int>(std::lround(kCell_m / map.resolution_m())));
  const CellRect& fine = map.rect();
  const CellRect rect{
      {floor_divide(fine.min.x, factor), floor_divide(fine.min.y, factor)},
      {floor_divide(fine.max.x - 1, factor) + 1, floor_divide(fine.max.y - 1, factor) + 1}};
  const double resolution_m = map.resolution_m() * factor;
  open_ = Grid<std::uint8_t>(resolution_m, rect, 0);
  Grid<std::uint8_t> occupied(resolution_m, rect, 0);
  for (std::size_t i = 0; i < map.size(); ++i) {
    const float value = map.values()[i];
    if (!is_known(value)) continue;
    const Cell cell = map.cell(i);
    const Cell coarse{floor_divide(cell.x, factor), floor_divide(cell.y, factor)};
    (is_occupied(value) ? occupied : open_).at(coarse) = 1;
  }
  const DistanceField distance = make_distance_field(occupied, 2.0 * robot_radius_m);
  for (std::size_t i = 0; i < open_.size(); ++i) {
    if (static_cast<double>(distance.values()[i]) <= robot_radius_m) open_.values()[i] = 0;
  }
}

std::optional<Cell> PathPlanner::nearest_open(const Eigen::Vector2d& point_m) const {
  const Cell at = open_.cell_at(point_m);
  const int reach = static_cast<int>(std::lround(kSnap_m / open_.resolution_m()));
  std::optional<Cell> best;
  int best2 = reach * reach + 1;
  for (int dy = -reach; dy <= reach; ++dy) {
    for (int dx = -reach; dx <= reach; ++dx) {
      const Cell cell{at.x + dx, at.y + dy};
      const int distance2 = dx * dx + dy * dy;
      if (distance2 >= best2 || open_.get(cell) == 0) continue;
      best = cell;
      best2 = distance2;
    }
  }
  return best;
}

std::optional<Path> PathPlanner::plan(const Eigen::Vector2d& start_m,
                                      const Eigen::Vector2d& goal_m) const {
  const std::optional<Cell> start = nearest_open(start_m);
  const std::optional<Cell> goal = nearest_open(goal_m);
  if (!start || !goal) return std::nullopt;
  constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  std::vector<double> cost(open_.size(), std::numeric_limits<double>::infinity());
  std::vector<std::size_t> parent(open_.size(), kNone);
  using Entry = std::pair<double, std::size_t>;  // estimate, place: ties go to the lower place
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  const std::size_t end = open_.index(*goal);
  cost[open_.index(*start)] = 0.0;
  queue.emplace(octile(*start, *goal), open_.index(*start));
  while (!queue.empty()) {
    const auto [estimate, place] = queue.top();
    queue.pop();
    const Cell cell = open_.cell(place);
    if (place == end) break;
    if (estimate > cost[place] + octile(cell, *goal) + 1e-9) continue;  // a better way was found
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const Cell next{cell.x + dx, cell.y + dy};
        if ((dx == 0 && dy == 0) || open_.get(next) == 0) continue;
        const double sum = cost[place] + (dx != 0 && dy != 0 ? std::numbers::sqrt2 : 1.0);
        const std::size_t there = open_.index(next);
        if (sum >= cost[there]) continue;
        cost[there] = sum;
        parent[there] = place;
        queue.emplace(sum + octile(next, *goal), there);
      }
    }
  }
  if (!std::isfinite(cost[end])) return std::nullopt;
  Path path;
  for (std::size_t place = end; place != kNone; place = parent[place]) {
    path.push_back(open_.center(open_.cell(place)));
  }
  std::reverse(path.begin(), path.end());
  return path;
}

double length_m(const Path& path) {
  double sum = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i) sum += (path[i] - path[i - 1]).norm();
  return sum;
}

double frechet_m(std::span<const Eigen::Vector2d> a, std::span<const Eigen::Vector2d> b) {
  std::vector<double> row(b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    double diagonal = 0.0;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const double above = row[j];
      double reached = 0.0;
      if (i == 0 && j > 0) reached = row[j - 1];
      if (i > 0 && j == 0) reached = above;
      if (i > 0 && j > 0) reached = std::min({above, row[j - 1], diagonal});
      row[j] = std::max(reached, (a[i] - b[j]).norm());
      diagonal = above;
    }
  }
  return row.back();
}

}  // namespace strata::pipeline
