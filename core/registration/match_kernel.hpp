// SPDX-License-Identifier: Apache-2.0
/// The inner loop of scan matching: cost and derivatives of all beams of a scan at one pose.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/pose2.hpp"
#include "core/registration/match_field.hpp"
#include "core/scan/endpoints.hpp"

namespace strata::registration {

/// End points with their weights as the kernel wants them: filled up with beams of weight zero to a
/// whole number of rows of eight.
struct MatchBeams {
  std::vector<double> x_m;
  std::vector<double> y_m;
  std::vector<double> weight;
  /// beam_weights: e(t, n) by beam, or empty for 1.
  MatchBeams(const Endpoints& endpoints, std::span<const float> beam_weights);
};

/// Sums over beams.
struct MatchSums {
  double weight = 0.0;
  double inlier_weight = 0.0;  ///< of weight x exp(-D^2 / 2 sigma_l^2)
  double log_mixture = 0.0;
  double gradient[3] = {0.0, 0.0, 0.0};
  double hessian[6] = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0};  ///< xx, xy, yy, xt, yt, tt
};

/// The mixture of docs/theory/slam.md, "Registration", for eq. (1.11) [stachniss2003chapter], with
/// gradient and Gauss-Newton Hessian of its negative logarithm (derivatives = false: zero). SIMD
/// over beams in eight partial sums: the same bits on every machine. O(beams).
[[nodiscard]] MatchSums sum_match(const MatchBeams& beams, const MatchField& field,
                                  const Pose2& pose, double hit_stddev_m, double hit_weight,
                                  bool derivatives);

}  // namespace strata::registration
