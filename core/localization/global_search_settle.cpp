// SPDX-License-Identifier: Apache-2.0
// Which end points are looked for, and where exactly a place of the lattice is.
#include <cmath>
#include <numbers>
#include <set>

#include "core/geometry/angle.hpp"
#include "core/localization/global_search.hpp"

namespace strata::localization {

double GlobalSearch::score_at(const Endpoints& endpoints, const Pose2& pose) const {
  const double c = std::cos(pose.theta);
  const double s = std::sin(pose.theta);
  double sum = 0.0;
  for (std::size_t i = 0; i < endpoints.size(); ++i) {
    const double x = pose.x + c * endpoints.x_m[i] - s * endpoints.y_m[i];
    const double y = pose.y + s * endpoints.x_m[i] + c * endpoints.y_m[i];
    sum += field_.at({x, y}) - least_;
  }
  return sum;
}

double GlobalSearch::settle(const Endpoints& endpoints, Pose2& map_from_robot) const {
  double best = score_at(endpoints, map_from_robot);
  double step_m = 0.5 * side_m_;
  double step_rad = std::numbers::pi / headings(endpoints);
  for (int halved = 0; halved < 3; ++halved) {
    bool is_moving = true;
    for (int round = 0; round < 4 && is_moving; ++round) {
      is_moving = false;
      for (int move = 0; move < 6; ++move) {
        Pose2 tried = map_from_robot;
        const double sign = (move % 2) == 0 ? 1.0 : -1.0;
        if (move < 2) tried.x += sign * step_m;
        if (move == 2 || move == 3) tried.y += sign * step_m;
        if (move > 3) tried.theta = wrap_angle(tried.theta + sign * step_rad);
        const double score = score_at(endpoints, tried);
        if (score <= best) continue;
        best = score;
        map_from_robot = tried;
        is_moving = true;
      }
    }
    step_m *= 0.5;
    step_rad *= 0.5;
  }
  return best;
}

Endpoints spread_out(const Endpoints& endpoints, double spacing_m, std::size_t max_points) {
  std::set<Cell> taken;
  const Endpoints thinned = those_of(endpoints, [&](std::size_t i) {
    return taken.insert(cell_at(endpoints.point_m(i), spacing_m)).second;
  });
  return subsample(thinned, max_points);
}

}  // namespace strata::localization
