// SPDX-License-Identifier: Apache-2.0
#include "core/localization/place_finder.hpp"

#include <algorithm>
#include <cmath>

namespace strata::localization {
namespace {

/// Closer together two places are one, which particles find by themselves.
constexpr double kSame_m = 0.2;
constexpr double kSame_rad = 0.1;

double reach_m(const Endpoints& points) {
  double reach_m = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    reach_m = std::max(reach_m, std::hypot(points.x_m[i], points.y_m[i]));
  }
  return reach_m;
}

/// The part of a map that beams reach from within radius_m of a place, where a robot may stand
/// there only.
ReflectionGrid surroundings(const ReflectionGrid& map, const Eigen::Vector2d& place_m,
                            double radius_m, double reach_m) {
  const Cell middle = cell_at(place_m, map.resolution_m());
  const int cells = static_cast<int>(std::ceil((radius_m + reach_m) / map.resolution_m())) + 1;
  const CellRect rect{{middle.x - cells, middle.y - cells}, {middle.x + cells, middle.y + cells}};
  ReflectionGrid part = map.cropped(rect.intersected(map.rect()));
  for (std::size_t i = 0; i < part.size(); ++i) {
    if (!is_free(part.values()[i])) continue;
    const bool is_near = (part.center(part.cell(i)) - place_m).norm() <= radius_m;
    if (!is_near) part.values()[i] = kUnknownReflection;
  }
  return part;
}

}  // namespace

PlaceSeed PlaceFinder::seed_at(const PlaceCandidate& candidate) const {
  return {candidate.map_from_robot, 0.7 * config_.search.separation_m,
          config_.search.separation_rad};
}

void PlaceFinder::set_map(const ReflectionGrid& map) {
  map_ = map;
  search_.reset();
}

void PlaceFinder::add(const Pose2& motion, const Scan& scan) {
  const Pose2 back = inverse(motion);
  for (Placed& placed : scans_) placed.now_from_then = back * placed.now_from_then;
  scans_.push_back({{}, endpoints_in_robot(scan)});
  while (scans_.size() > static_cast<std::size_t>(config_.local_scans)) scans_.pop_front();
}

/// Of all scans that are kept, in the robot's frame. The newest first: of end points in one square
/// the first is kept.
Endpoints PlaceFinder::points() const {
  Endpoints all;
  for (auto placed = scans_.rbegin(); placed != scans_.rend(); ++placed) {
    for (std::size_t i = 0; i < placed->points.size(); ++i) {
      const Eigen::Vector2d at =
          placed->now_from_then * Eigen::Vector2d(placed->points.x_m[i], placed->points.y_m[i]);
      all.x_m.push_back(at.x());
      all.y_m.push_back(at.y());
      all.beam.push_back(placed->points.beam[i]);
    }
  }
  return spread_out(all, config_.search.resolution_m,
                    static_cast<std::size_t>(config_.search.max_points));
}

std::vector<PlaceSeed> PlaceFinder::find(int waited) {
  if (search_ == nullptr) search_ = std::make_shared<const GlobalSearch>(map_, config_.search);
  const std::vector<PlaceCandidate> candidates = search_->search(points());
  const bool are_more =
      candidates.size() >= static_cast<std::size_t>(config_.search.max_candidates);
  if (are_more && waited < config_.patience) return {};
  std::vector<PlaceSeed> seeds;
  for (const PlaceCandidate& candidate : candidates) seeds.push_back(seed_at(candidate));
  return seeds;
}

std::optional<PlaceSeed> PlaceFinder::find_better(const Pose2& map_from_robot, double radius_m,
                                                  double turn_rad) const {
  const Endpoints all = points();
  if (!has_map() || all.size() == 0) return std::nullopt;
  const GlobalSearch search(
      surroundings(map_, map_from_robot.translation(), radius_m, reach_m(all)), config_.search);
  Pose2 here = map_from_robot;
  const double score_here = search.settle(all, here);
  for (const PlaceCandidate& candidate : search.search(all)) {
    if (candidate.score <= score_here) break;
    const Pose2 off = between(map_from_robot, candidate.map_from_robot);
    const double off_m = off.translation().norm();
    if (std::abs(off.theta) > turn_rad || off_m > radius_m) continue;
    if (std::abs(off.theta) < kSame_rad && off_m < kSame_m) break;
    return seed_at(candidate);
  }
  return std::nullopt;
}

}  // namespace strata::localization
