// SPDX-License-Identifier: Apache-2.0
#include "core/refinement/pose_refiner.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "core/geometry/angle.hpp"

namespace strata::refinement {
namespace {

constexpr double kHitWeight = 0.95;
constexpr std::size_t kMinOddHits = 20;  // a half
/// Beams are correlated: a scan says as much as so many that are not.
constexpr double kEffectiveBeams = 30.0;
/// A level. Along a bare wall every step meets other cells.
constexpr int kMaxIterations = 60;
/// The filter has weighed this scan already: what it says beside counts as known four times worse.
constexpr double kPriorInflation = 4.0;

/// Every other hit.
std::array<Endpoints, 2> halves_of(const Endpoints& hits) {
  return {those_of(hits, [](std::size_t i) { return i % 2 == 0; }),
          those_of(hits, [](std::size_t i) { return i % 2 == 1; })};
}

Eigen::Vector3d from(const Pose2& mean, const Pose2& pose) {
  return {pose.x - mean.x, pose.y - mean.y, angle_difference(pose.theta, mean.theta)};
}

}  // namespace

PoseRefiner::PoseRefiner(const ReflectionGrid& map, const SurfaceLayer& layer,
                         const patch::PatchMap* patches, const RefinementConfig& config)
    : config_(config), surfaces_(map, layer, patches) {
  require_valid(config, "refinement");
}

std::optional<Pose2Gaussian> PoseRefiner::registered(const Endpoints& used, const Endpoints& others,
                                                     const Pose2Gaussian& filtered) const {
  const registration::MatchConfig match{.hit_weight = kHitWeight,
                                        .hit_stddev_m = config_.hit_stddev_m,
                                        .levels = 1,
                                        .max_iterations = kMaxIterations,
                                        .effective_beams = kEffectiveBeams,
                                        .min_inlier_share = config_.min_inlier_share};
  const registration::MatchField& field = surfaces_.field();
  const Pose2Gaussian prior{filtered.mean, kPriorInflation * filtered.covariance};
  const registration::MatchResult found =
      registration::match(used, {}, field, filtered.mean, &prior, match);
  if (!found.converged) return std::nullopt;
  const auto cost = [&](const Pose2& pose) {
    return registration::evaluate_match(others, {}, field, pose, nullptr, config_.hit_stddev_m,
                                        kHitWeight)
        .scan_cost;
  };
  // One nat is no evidence: the filter's pose may be as good.
  const double nat = std::max(1.0, static_cast<double>(others.size()) / kEffectiveBeams);
  if (!(cost(found.pose) <= cost(filtered.mean) + nat)) return std::nullopt;
  return found.gaussian();
}

std::optional<Pose2Gaussian> PoseRefiner::refine(const Scan& scan,
                                                 const localization::LocalizationResult& result) {
  if (result.score < config_.min_score || result.is_ambiguous || result.health.is_in_doubt) {
    return std::nullopt;
  }
  const auto [even, odd] =
      halves_of(subsample(endpoints_in_robot(scan), static_cast<std::size_t>(config_.max_beams)));
  if (odd.size() < kMinOddHits) return std::nullopt;
  surfaces_.believe(result.submaps, config_.min_configuration);
  const std::optional<Pose2Gaussian> first = registered(even, odd, result.pose);
  if (!first) return std::nullopt;
  const std::optional<Pose2Gaussian> second = registered(odd, even, result.pose);
  if (!second) return std::nullopt;
  const Eigen::Vector3d apart = from(first->mean, second->mean);
  const Pose2 middle{first->mean.x + 0.5 * apart.x(), first->mean.y + 0.5 * apart.y(),
                     wrap_angle(first->mean.theta + 0.5 * apart.z())};
  if (!(translation_distance(middle, result.pose.mean) <= config_.max_shift_m)) return std::nullopt;
  Pose2Gaussian refined{middle, 0.25 * (first->covariance + second->covariance)};
  refined.covariance += 0.25 * apart * apart.transpose();
  const double map_stddev_m = std::hypot(config_.map_stddev_m, surfaces_.stddev_m());
  refined.covariance(0, 0) += map_stddev_m * map_stddev_m;
  refined.covariance(1, 1) += map_stddev_m * map_stddev_m;
  return refined;
}

}  // namespace strata::refinement
