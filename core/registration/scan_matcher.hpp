// SPDX-License-Identifier: Apache-2.0
/// Scan-to-map matching with a robust mixture cost, covariance and an honest `converged`.
#pragma once

#include <span>

#include <Eigen/Core>

#include "core/base/config.hpp"
#include "core/geometry/pose2_gaussian.hpp"
#include "core/registration/match_field.hpp"
#include "core/scan/endpoints.hpp"

namespace strata::registration {

struct MatchConfig {
  double hit_weight = 0.95;
  double hit_stddev_m = 0.05;
  int levels = 3;
  int max_iterations = 20;
  double effective_beams = 30.0;
  double min_inlier_share = 0.35;
  double max_condition_stddev_m = 0.5;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("hit_weight", c.hit_weight,
            {.doc = "w_h: share of beams that are inliers of the map; the rest is uniform",
             .unit = "1",
             .min = 0.01,
             .max = 0.999});
    v.field("hit_stddev_m", c.hit_stddev_m,
            {.doc = "sigma_l of the finest level: spread of hits about a surface",
             .unit = "m",
             .min = 0.005,
             .max = 1.0});
    v.field("levels", c.levels,
            {.doc = "coarse to fine, sigma_l doubles from level to level", .min = 1, .max = 6});
    v.field("max_iterations", c.max_iterations,
            {.doc = "iterations a level, at most", .min = 1, .max = 200});
    v.field("effective_beams", c.effective_beams,
            {.doc = "beams of one scan are correlated: the covariance counts them as this many",
             .min = 1.0});
    v.renamed("min_explained", "min_inlier_share");
    v.removed("solver", "matching has one solver");
    v.field("min_inlier_share", c.min_inlier_share,
            {.doc = "below this share of inlier beams a match has not converged",
             .unit = "1",
             .min = 0.0,
             .max = 1.0});
    v.field("max_condition_stddev_m", c.max_condition_stddev_m,
            {.doc = "a match whose position is less certain than this in its worst direction has "
                    "not converged (a bare corridor without a prior)",
             .unit = "m",
             .min = 0.01});
  }
};

/// What matching found. pose and covariance: map_from_robot, as Pose2Gaussian states it.
struct MatchResult {
  Pose2 pose;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  bool converged = false;
  double cost = 0.0;          ///< nats, cost at `pose` on the finest level; 0 for a perfect match
  double inlier_share = 0.0;  ///< weighted mean over hits of exp(-D^2 / 2 sigma_l^2), 0 ... 1
  int iterations = 0;

  [[nodiscard]] Pose2Gaussian gaussian() const { return {pose, covariance}; }
};

/// Minimizes the negative of (1.11) [stachniss2003chapter]; docs/theory/slam.md, "Registration":
///   sum_n e_n ( ln(w_h + w_r) - ln[ w_h exp(-D(T z_n)^2 / 2 sigma_l^2) + w_r ] )
///     + 1/2 |x - prior|^2,
/// from `guess`, coarse to fine. e_n: beam_weights[endpoints.beam[n]], or 1 when beam_weights is
/// empty. D: distance to the surface (MatchField). A result that costs more than the guess on the
/// finest level is replaced by the guess. No hits: guess (or prior mean) back, converged = false.
/// Endpoints are in the robot frame. O(levels x iterations x hits). Thread-safe.
[[nodiscard]] MatchResult match(const Endpoints& endpoints, std::span<const float> beam_weights,
                                const MatchField& field, const Pose2& guess,
                                const Pose2Gaussian* prior, const MatchConfig& config = {});

/// The cost above at one pose and one sigma_l [nats], with gradient and Gauss-Newton Hessian on
/// request (the mixture as iteratively re-weighted least squares). The nearest surface is held
/// fixed in the derivatives. O(hits).
struct MatchCost {
  double cost = 0.0;
  double scan_cost = 0.0;  ///< the beams' part of it
  double inlier_share = 0.0;
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
};
[[nodiscard]] MatchCost evaluate_match(const Endpoints& endpoints,
                                       std::span<const float> beam_weights, const MatchField& field,
                                       const Pose2& pose, const Pose2Gaussian* prior,
                                       double hit_stddev_m, double hit_weight);

}  // namespace strata::registration
