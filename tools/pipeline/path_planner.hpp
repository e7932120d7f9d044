// SPDX-License-Identifier: Apache-2.0
/// Shortest ways through a grid map, and how alike two of them are.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/grid/grid.hpp"
#include "core/grid/reflection_grid.hpp"

namespace strata::pipeline {

using Path = std::vector<Eigen::Vector2d>;

/// A map made ready for a round robot: cells of about 0.1 m that are known and far enough from
/// every obstacle. O(cells).
class PathPlanner {
 public:
  PathPlanner(const ReflectionGrid& map, double robot_radius_m);

  /// Shortest way over the eight neighbours (A* with the octile distance) between the cells nearest
  /// to start and goal, at most 0.5 m away, that the robot may stand in; nothing when there is
  /// none. Deterministic. O(cells log cells).
  [[nodiscard]] std::optional<Path> plan(const Eigen::Vector2d& start_m,
                                         const Eigen::Vector2d& goal_m) const;

 private:
  [[nodiscard]] std::optional<Cell> nearest_open(const Eigen::Vector2d& point_m) const;

  Grid<std::uint8_t> open_;
};

/// Metres along the path.
[[nodiscard]] double length_m(const Path& path);

/// Discrete Frechet distance [eiter1994frechet] between two paths of at least one point. O(n m).
[[nodiscard]] double frechet_m(std::span<const Eigen::Vector2d> a,
                               std::span<const Eigen::Vector2d> b);

}  // namespace strata::pipeline
