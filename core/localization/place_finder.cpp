// SPDX-License-Identifier: Apache-2.0
#include "core/localization/place_finder.hpp"

#include <algorithm>

namespace strata::localization {
namespace {

bool is_same(const ReflectionGrid& a, const ReflectionGrid& b) {
  return a.rect() == b.rect() && a.resolution_m() == b.resolution_m() &&
         std::equal(a.values().begin(), a.values().end(), b.values().begin(),
                    [](float x, float y) { return x == y || (!is_known(x) && !is_known(y)); });
}

}  // namespace

void PlaceFinder::set_map(const ReflectionGrid& map) {
  if (map_ != nullptr && is_same(*map_, map)) return;
  map_ = std::make_shared<const ReflectionGrid>(map);
  search_.reset();
}

void PlaceFinder::add(const Pose2& motion, const Scan& scan) {
  const Pose2 back = inverse(motion);
  for (Placed& placed : scans_) placed.now_from_then = back * placed.now_from_then;
  scans_.push_back({{}, endpoints_in_robot(scan)});
  while (scans_.size() > static_cast<std::size_t>(config_.local_scans)) scans_.pop_front();
}

std::vector<PlaceSeed> PlaceFinder::find(int waited) {
  if (search_ == nullptr) search_ = std::make_shared<const GlobalSearch>(*map_, config_.search);
  // The newest first: of end points in one square the first is kept.
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
  const std::vector<PlaceCandidate> candidates = search_->search(spread_out(
      all, config_.search.resolution_m, static_cast<std::size_t>(config_.search.max_points)));
  const bool are_more =
      candidates.size() >= static_cast<std::size_t>(config_.search.max_candidates);
  if (are_more && waited < config_.patience) return {};
  std::vector<PlaceSeed> seeds;
  for (const PlaceCandidate& candidate : candidates) {
    seeds.push_back({candidate.map_from_robot, 0.7 * config_.search.separation_m,
                     config_.search.separation_rad});
  }
  return seeds;
}

}  // namespace strata::localization
