// SPDX-License-Identifier: Apache-2.0
#include "core/slam/scan_fit.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "core/slam/submap.hpp"

namespace strata::slam {
namespace {

constexpr std::size_t kMostHits = 200;

std::vector<Eigen::Vector2d> hits_of(const Scan& scan) {
  std::vector<std::size_t> beams;
  for (std::size_t beam = 0; beam < scan.size(); ++beam) {
    if (scan.kind(beam) == BeamKind::kHit) beams.push_back(beam);
  }
  const std::size_t stride = std::max<std::size_t>(1, (beams.size() + kMostHits - 1) / kMostHits);
  std::vector<Eigen::Vector2d> hits;
  for (std::size_t i = 0; i < beams.size(); i += stride) {
    const auto range_m = static_cast<double>(scan.ranges_m[beams[i]]);
    const double bearing_rad = scan.bearing_rad(beams[i]);
    hits.push_back(scan.robot_from_laser * Eigen::Vector2d(range_m * std::cos(bearing_rad),
                                                           range_m * std::sin(bearing_rad)));
  }
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
  std::size_t surface = 0;
  std::size_t free = 0;
  for (const Eigen::Vector2d& hit : hits) {
    const SurfaceState state = state_near(states, map_from_robot * hit);
    surface += state == SurfaceState::kOccupied ? 1 : 0;
    free += state == SurfaceState::kFree ? 1 : 0;
  }
  return agreement_of(surface, free, hits.size());
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
        if (fit.explained() > best.explained()) best = fit;
      }
    }
  }
  return best;
}

}  // namespace strata::slam
