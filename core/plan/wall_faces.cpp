// SPDX-License-Identifier: Apache-2.0
#include "core/plan/wall_faces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <set>
#include <tuple>

namespace strata::plan {
namespace {

constexpr int kMinNeighbours = 3;
/// Least to greatest spread of a cell's neighbours from where on they run in no direction.
constexpr double kRound = 0.6;

/// Across the line that the border cells within `reach` run along; none where they run along none.
std::optional<Eigen::Vector2d> across(const Grid<std::uint8_t>& border, const Cell& cell,
                                      int reach) {
  double n = 0.0;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double xx = 0.0, xy = 0.0, yy = 0.0;
  for (int dy = -reach; dy <= reach; ++dy) {
    for (int dx = -reach; dx <= reach; ++dx) {
      if (dx * dx + dy * dy > reach * reach + 1) continue;  // round: no direction is favoured
      if (border.get({cell.x + dx, cell.y + dy}) == 0) continue;
      n += 1.0;
      sum += Eigen::Vector2d(dx, dy);
      xx += dx * dx;
      xy += dx * dy;
      yy += dy * dy;
    }
  }
  if (n < kMinNeighbours) return std::nullopt;
  const Eigen::Vector2d mean = sum / n;
  xx = xx / n - mean.x() * mean.x();
  xy = xy / n - mean.x() * mean.y();
  yy = yy / n - mean.y() * mean.y();
  const double half_turn = 0.5 * std::atan2(2.0 * xy, xx - yy);  // of the line
  const double middle = 0.5 * (xx + yy);
  const double apart = std::hypot(0.5 * (xx - yy), xy);
  if (middle - apart > kRound * (middle + apart)) return std::nullopt;
  return Eigen::Vector2d(-std::sin(half_turn), std::cos(half_turn));
}

/// How far across the line the hits lie from the middle of the cell in the mean: pose errors smear
/// a wall over cells, and its hits over both sides of a border.
double hits_across_m(const ReflectionGrid& map, const Cell& cell, const Eigen::Vector2d& normal) {
  double sum = 0.0;
  double weights = 0.0;
  for (int dy = -2; dy <= 2; ++dy) {
    for (int dx = -2; dx <= 2; ++dx) {
      const float value = map.get({cell.x + dx, cell.y + dy});
      if (!is_known(value)) continue;
      sum += static_cast<double>(value) * normal.dot(Eigen::Vector2d(dx, dy));
      weights += static_cast<double>(value);
    }
  }
  return weights > 0.0 ? map.resolution_m() * sum / weights : 0.0;
}

}  // namespace

std::vector<WallFace> seen_faces(const ReflectionGrid& map, const SurfaceLayer& surfaces) {
  const double cell_m = map.resolution_m();
  Grid<std::uint8_t> border(cell_m, map.rect(), 0);
  Grid<std::int32_t> surface(cell_m, surfaces.cells.empty() ? CellRect{} : map.rect(), -1);
  for (std::size_t i = 0; i < surfaces.cells.size(); ++i) {
    if (surface.contains(surfaces.cell(i))) {
      surface.at(surfaces.cell(i)) = static_cast<std::int32_t>(i);
    }
  }
  for (std::size_t i = 0; i < map.size(); ++i) {
    const auto is_by_free = [&](const Cell& other) { return is_free(map.get(other)); };
    if (is_occupied(map.values()[i]) && any_beside(map.cell(i), is_by_free)) border.values()[i] = 1;
  }
  std::vector<WallFace> faces;
  for (std::size_t i = 0; i < border.size(); ++i) {
    if (border.values()[i] == 0) continue;
    const Cell cell = border.cell(i);
    const auto normal = across(border, cell, 3);
    if (!normal) continue;
    const std::int32_t known = surface.get(cell);
    const Eigen::Vector2d at =
        known < 0 ? Eigen::Vector2d(map.center(cell) + hits_across_m(map, cell, *normal) * *normal)
                  : surfaces.position_m(static_cast<std::size_t>(known));
    for (const double side : {1.0, -1.0}) {
      const Eigen::Vector2d out = side * *normal;
      if (is_free(map.get(map.cell_at(at + 2.5 * cell_m * out)))) faces.push_back({at, out});
    }
  }
  return faces;
}

std::vector<WallFace> drawn_faces(const ReflectionGrid& plan) {
  const double cell_m = plan.resolution_m();
  const auto is_dark = [&](const Cell& cell) { return is_occupied(plan.get(cell)); };
  Grid<std::uint8_t> border(cell_m, plan.rect(), 0);
  for (std::size_t i = 0; i < plan.size(); ++i) {
    const Cell c = plan.cell(i);
    if (!is_dark(c)) continue;
    const bool is_edge = !is_dark({c.x - 1, c.y}) || !is_dark({c.x + 1, c.y}) ||
                         !is_dark({c.x, c.y - 1}) || !is_dark({c.x, c.y + 1});
    if (is_edge) border.values()[i] = 1;
  }
  std::vector<WallFace> faces;
  for (std::size_t i = 0; i < border.size(); ++i) {
    if (border.values()[i] == 0) continue;
    const Cell cell = border.cell(i);
    const auto normal = across(border, cell, 4);
    if (!normal) continue;
    for (const double side : {1.0, -1.0}) {
      const Eigen::Vector2d out = side * *normal;
      const Eigen::Vector2d at = plan.center(cell);
      if (!is_dark(plan.cell_at(at + 1.5 * cell_m * out))) {
        faces.push_back({at + 0.5 * cell_m * out, out});
      }
    }
  }
  return faces;
}

int direction_of(const Eigen::Vector2d& normal) {
  const double turn = std::atan2(normal.y(), normal.x()) / (2.0 * std::numbers::pi);
  return static_cast<int>(std::floor((turn + 1.0) * kDirections)) % kDirections;
}

std::vector<WallFace> thinned(const std::vector<WallFace>& faces, double square_m) {
  std::set<std::tuple<int, int, int>> taken;
  std::vector<WallFace> kept;
  for (const WallFace& face : faces) {
    const Cell cell = cell_at(face.at_m, square_m);
    if (taken.insert({cell.y, cell.x, direction_of(face.normal)}).second) kept.push_back(face);
  }
  return kept;
}

}  // namespace strata::plan
