// SPDX-License-Identifier: Apache-2.0
#include "core/slam/scan_fit.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "core/scan/endpoints.hpp"
#include "core/tracking/local_map.hpp"

namespace strata::slam {
namespace {

constexpr std::size_t kMaxHits = 200;

std::vector<Eigen::Vector2d> hits_of(const Scan& scan) {
  const Endpoints all = endpoints_in_robot(scan);
  const std::size_t stride = std::max<std::size_t>(1, (all.size() + kMaxHits - 1) / kMaxHits);
  std::vector<Eigen::Vector2d> hits;
  for (std::size_t i = 0; i < all.size(); i += stride) hits.emplace_back(all.x_m[i], all.y_m[i]);
  return hits;
}

/// Cells and those beside surfaces: poses are tried in steps.
StateGrid states_of(const ReflectionGrid& map) {
  StateGrid states(map.resolution_m(), map.rect(), SurfaceState::kUnknown);
  for (std::size_t i = 0; i < map.size(); ++i) {
    const float value = map.values()[i];
    if (!is_known(value)) continue;
    states.values()[i] = is_occupied(value) ? SurfaceState::kOccupied : SurfaceState::kFree;
  }
  return states;
}

Agreement agreement_at(const StateGrid& states, const std::vector<Eigen::Vector2d>& hits,
                       const Pose2& map_from_robot) {
  return agreement_with(states, hits,
                        [&](const Eigen::Vector2d& hit) { return map_from_robot * hit; });
}

}  // namespace

ScanFit fit_near(const ReflectionGrid& map, const Scan& scan, const Pose2& map_from_robot,
                 const FitReach& reach) {
  ScanFit best{map_from_robot, {}};
  const std::vector<Eigen::Vector2d> hits = hits_of(scan);
  if (hits.empty() || map.size() == 0) return best;
  const StateGrid states = states_of(map);
  const int steps = static_cast<int>(reach.reach_m / reach.step_m);
  const int turns = static_cast<int>(reach.reach_rad / reach.step_rad);
  best.agreement = agreement_at(states, hits, map_from_robot);
  for (int turn = -turns; turn <= turns; ++turn) {
    for (int x = -steps; x <= steps; ++x) {
      for (int y = -steps; y <= steps; ++y) {
        ScanFit fit;
        fit.map_from_robot = {map_from_robot.x + x * reach.step_m,
                              map_from_robot.y + y * reach.step_m,
                              map_from_robot.theta + turn * reach.step_rad};
        fit.agreement = agreement_at(states, hits, fit.map_from_robot);
        if (fit.inlier_share() > best.inlier_share()) best = fit;
      }
    }
  }
  return best;
}

}  // namespace strata::slam
