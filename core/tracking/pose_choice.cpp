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

/// How odd a pose is by odometry [nats, Student's t with one degree of freedom], `most` at most.
double surprise(const Pose2& pose, const Pose2Gaussian& guess, double most) {
  return std::min(most, 2.0 * std::log1p(mahalanobis_squared(guess, pose)));
}

Endpoints known_from_both(const Endpoints& endpoints, const SurfaceMap& map, const Pose2& a,
                          const Pose2& b) {
  const auto is_known = [&](const Eigen::Vector2d& end_m) {
    return map.state(end_m) != SurfaceState::kUnknown;
  };
  Endpoints known;
  for (std::size_t i = 0; i < endpoints.size(); ++i) {
    const Eigen::Vector2d end_m(endpoints.x_m[i], endpoints.y_m[i]);
    if (!is_known(a * end_m) || !is_known(b * end_m)) continue;
    known.x_m.push_back(endpoints.x_m[i]);
    known.y_m.push_back(endpoints.y_m[i]);
    known.beam.push_back(endpoints.beam[i]);
  }
  return known;
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
