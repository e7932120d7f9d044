// SPDX-License-Identifier: Apache-2.0
#include "core/tracking/pose_choice.hpp"

#include <algorithm>
#include <cmath>

namespace strata::slam {
namespace {

constexpr double kMaxSurprise = 6.0;

/// With fewer beams known from both poses than this share one of the two lies in the unknown as a
/// whole, as after wheels spun: then all beams are asked.
constexpr double kMinKnownShare = 0.1;

/// Stands, pillars and doors that look alike lie no closer than this. What a match finds nearer by
/// is the same place.
constexpr double kLookAlikeM = 0.6;

/// A beam is followed in steps of this share of a cell, to so far before its end.
constexpr double kStepCells = 0.5;
constexpr double kBeforeEndM = 0.15;

/// How odd a pose is by odometry [nats, Student's t with one degree of freedom], `most` at most.
double surprise(const Pose2& pose, const Pose2Gaussian& guess, double most) {
  return std::min(most, 2.0 * std::log1p(mahalanobis_squared(guess, pose)));
}

/// Whether a beam from the robot passes a surface well before its end.
bool goes_through(const SurfaceMap& map, const Eigen::Vector2d& from_m,
                  const Eigen::Vector2d& end_m) {
  const double length_m = (end_m - from_m).norm();
  const Eigen::Vector2d direction = (end_m - from_m) / length_m;
  const double step_m = kStepCells * map.field().resolution_m();
  for (double way_m = 0.0; way_m < length_m - kBeforeEndM; way_m += step_m) {
    if (map.state(from_m + way_m * direction) == SurfaceState::kOccupied) return true;
  }
  return false;
}

/// What ends in the unknown behind a surface is known not to fit.
bool is_known(const SurfaceMap& map, const Pose2& pose, const Eigen::Vector2d& end_m) {
  const Eigen::Vector2d at_m = pose * end_m;
  return map.state(at_m) != SurfaceState::kUnknown || goes_through(map, pose.translation(), at_m);
}

Endpoints known_from_both(const Endpoints& endpoints, const SurfaceMap& map, const Pose2& a,
                          const Pose2& b) {
  return those_of(endpoints, [&](std::size_t i) {
    const Eigen::Vector2d end_m = endpoints.point_m(i);
    return is_known(map, a, end_m) && is_known(map, b, end_m);
  });
}

}  // namespace

double likelier_by(const Pose2& other, const Pose2& own, const Endpoints& endpoints,
                   const SurfaceMap& map, const registration::MatchConfig& config) {
  const Endpoints both = known_from_both(endpoints, map, own, other);
  const bool are_enough =
      static_cast<double>(both.size()) >= kMinKnownShare * static_cast<double>(endpoints.size());
  const Endpoints& asked = are_enough ? both : endpoints;
  const auto cost_at = [&](const Pose2& pose) {
    return registration::evaluate_match(asked, {}, map.field(), pose, nullptr, config.hit_stddev_m,
                                        config.hit_weight)
        .scan_cost;
  };
  return cost_at(own) - cost_at(other);
}

double odder_by(const Pose2& other, const Pose2& own, const Pose2Gaussian& guess, double doubt) {
  const bool may_look_alike = translation_distance(other, own) > kLookAlikeM;
  const double most = may_look_alike ? kMaxSurprise / doubt : kMaxSurprise;
  return surprise(other, guess, most) - surprise(own, guess, most);
}

}  // namespace strata::slam
