// SPDX-License-Identifier: Apache-2.0
/// Buildings of straight walls, as a map that saw them and as drawings.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Core>

#include "core/geometry/pose2.hpp"
#include "core/grid/reflection_grid.hpp"
#include "core/plan/plan_registration.hpp"

namespace strata::test {

struct Line {
  Eigen::Vector2d a;
  Eigen::Vector2d b;
};

inline double distance_m(const Eigen::Vector2d& p, const Line& line) {
  const Eigen::Vector2d along = line.b - line.a;
  const double t = std::clamp((p - line.a).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (p - line.a - t * along).norm();
}

/// Cells whose middle is within `half_m` of a line are 1, all others `otherwise`.
inline ReflectionGrid painted(const std::vector<Line>& lines, double half_m, double cell_m,
                              double reach_m, float otherwise) {
  const int reach = static_cast<int>(std::ceil(reach_m / cell_m));
  ReflectionGrid grid(cell_m, {{-reach, -reach}, {reach, reach}}, otherwise);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const Eigen::Vector2d at = grid.center(grid.cell(i));
    const auto is_near = [&](const Line& line) { return distance_m(at, line) <= half_m; };
    if (std::any_of(lines.begin(), lines.end(), is_near)) grid.values()[i] = 1.0F;
  }
  return grid;
}

inline void add_box(std::vector<Line>& lines, double x0, double y0, double x1, double y1) {
  lines.push_back({{x0, y0}, {x1, y0}});
  lines.push_back({{x1, y0}, {x1, y1}});
  lines.push_back({{x1, y1}, {x0, y1}});
  lines.push_back({{x0, y1}, {x0, y0}});
}

/// Three rooms of which no two are alike.
inline std::vector<Line> building() {
  std::vector<Line> lines;
  add_box(lines, -5.0, -3.0, 5.0, 3.0);
  lines.push_back({{-1.5, -3.0}, {-1.5, 1.2}});
  lines.push_back({{-1.5, 2.3}, {-1.5, 3.0}});
  lines.push_back({{-0.3, 0.4}, {5.0, 0.4}});
  return lines;
}

/// One that is the same after half a turn.
inline std::vector<Line> hall() {
  std::vector<Line> lines;
  add_box(lines, -5.0, -3.0, 5.0, 3.0);
  return lines;
}

/// What a robot maps of it, with cupboards that no plan has.
inline ReflectionGrid seen(std::vector<Line> lines, bool is_furnished = true) {
  if (is_furnished) {
    add_box(lines, -4.9, -2.0, -4.4, -0.5);
    add_box(lines, 3.0, 2.3, 4.2, 2.9);
  }
  return painted(lines, 0.026, 0.05, 7.0, 0.0F);
}

/// A plan in which the building lies so; its metres are 1/scale.
inline ReflectionGrid drawn(const std::vector<Line>& lines,
                            const plan::SiteFromPlan& site_from_plan, double thick_m = 0.03,
                            double pixel_m = 0.02) {
  std::vector<Line> turned;
  const Pose2 back = inverse(site_from_plan.pose);
  for (const Line& line : lines) {
    turned.push_back({back * line.a / site_from_plan.scale, back * line.b / site_from_plan.scale});
  }
  return painted(turned, 0.5 * thick_m, pixel_m, 10.0, 0.0F);
}

}  // namespace strata::test
