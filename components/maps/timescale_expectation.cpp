// SPDX-License-Identifier: Apache-2.0
// What nodes over a base map expect at one pose, and which beams are as they expect.
#include <algorithm>
#include <cmath>
#include <limits>

#include "components/maps/timescale_model.hpp"
#include "core/localization/unjudged_beams.hpp"

namespace strata::maps {
namespace {

constexpr double kNoReturn_m = std::numeric_limits<double>::infinity();

}  // namespace

using memory::NodeOutline;
using rays::BeamMixture;
using rays::ScanBeams;

NodeOutline::Reach TimescaleModel::reach_at(int level, const Eigen::Vector2d& laser_m,
                                            const Eigen::Vector2d& direction,
                                            double r_max_m) const {
  NodeOutline::Reach reach = map_->reach(map_->view(level, laser_m), direction);
  if (!reach.is_open_ended(r_max_m) || !has_base_at(laser_m)) return reach;
  const double base_m =
      base_->range_m(laser_m.x(), laser_m.y(), direction.x(), direction.y(), r_max_m);
  reach.range_m = beyond_m(laser_m, direction, reach.range_m, base_m, r_max_m);
  reach.end = std::isinf(reach.range_m) ? NodeOutline::Edge::kOpen : NodeOutline::Edge::kSurface;
  return reach;
}

localization::InlierShares TimescaleModel::inlier_shares(
    const Scan& scan, const Pose2& map_from_robot,
    const localization::ParticleSet& /*particles*/) const {
  const auto scratch = scratch_.acquire();
  select_beams(scan, config_.beams, scratch->beams);
  const ScanBeams& beams = scratch->beams;
  if (beams.size() == 0) return {};
  const BeamMixture mixture = beam_mixture_.limited_to(beams.r_max_m);
  const Pose2 laser = map_from_robot * beams.robot_from_laser;
  const BelievedLevels levels = believed();
  localization::InlierShares said;
  for (std::size_t k = 0; k < beams.size(); ++k) {
    const double angle = laser.theta + beams.bearing_rad[k];
    const Eigen::Vector2d direction(std::cos(angle), std::sin(angle));
    bool is_seen = false;
    bool is_stopped = beams.is_hit[k] != 0;
    const bool is_inlier = std::any_of(levels.begin(), levels.end(), [&](const Believed& level) {
      const auto reach = reach_at(level.level, laser.translation(), direction, beams.r_max_m);
      if (reach.end == NodeOutline::Edge::kUnseen && reach.range_m < beams.r_max_m) return false;
      is_seen = true;
      is_stopped = is_stopped && beams.range_m[k] < reach.range_m;
      // What lies beyond a free way is unknown: a beam that goes as far is as expected.
      if (reach.is_open_ended(beams.r_max_m)) {
        return beams.range_m[k] >= reach.range_m;
      }
      return mixture.is_inlier(beams.is_hit[k] != 0, beams.range_m[k], reach.range_m);
    });
    said.inlier += is_inlier ? 1.0 : 0.0;
    said.judged += is_seen ? 1.0 : 0.0;
    said.stopped += is_seen && !is_inlier && is_stopped ? 1.0 : 0.0;
  }
  // Levels say how far a beam goes, not what stands behind.
  said.met = said.inlier;
  said.at_surface = said.inlier;
  said.divide_by(static_cast<double>(beams.size()));
  return said;
}

void TimescaleModel::find_unjudged(const Scan& scan, const Pose2& map_from_robot,
                                   std::vector<std::uint8_t>& is_unjudged) const {
  if (base_ == nullptr) return SensorModel::find_unjudged(scan, map_from_robot, is_unjudged);
  const Pose2 laser = map_from_robot * scan.robot_from_laser;
  const auto expected_m = [&](std::size_t /*beam*/, const Eigen::Vector2d& direction,
                              double limit_m) {
    return base_->range_m(laser.x, laser.y, direction.x(), direction.y(), limit_m);
  };
  localization::mark_unjudged(*base_, scan, laser, beam_mixture_.tolerance_m(), expected_m,
                              is_unjudged);
}

double TimescaleModel::expected_range_m(const Pose2& map_from_laser, double bearing_rad) const {
  const double angle = map_from_laser.theta + bearing_rad;
  const Eigen::Vector2d direction(std::cos(angle), std::sin(angle));
  for (const Believed& level : believed()) {
    const auto reach =
        reach_at(level.level, map_from_laser.translation(), direction, map_->bins().max_range_m);
    if (reach.end == NodeOutline::Edge::kSurface) return reach.range_m;
    if (reach.end == NodeOutline::Edge::kOpen) return kNoReturn_m;
  }
  return kNoReturn_m;
}

}  // namespace strata::maps
