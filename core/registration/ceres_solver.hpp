// SPDX-License-Identifier: Apache-2.0
/// The matching cost as a Ceres problem. No Ceres type shows here.
#pragma once

#include <span>

#include "core/geometry/pose2_gaussian.hpp"
#include "core/registration/match_field.hpp"
#include "core/scan/endpoints.hpp"

namespace strata::registration {

struct LevelResult {
  Pose2 pose;
  bool converged = false;
  int iterations = 0;
};

/// Minimizes the cost of `match` on one level with Ceres, on one thread.
[[nodiscard]] LevelResult minimize_with_ceres(const Endpoints& endpoints,
                                              std::span<const float> beam_weights,
                                              const MatchField& field, const Pose2& start,
                                              const Pose2Gaussian* prior, double hit_stddev_m,
                                              double hit_weight, int max_iterations);

/// Residuals and Jacobian (row-major 2 x 3) of one beam at a pose, as the Ceres problem has them:
/// whitened distance across and along the nearest surface. False: nothing near. For tests against
/// finite differences.
[[nodiscard]] bool beam_residual(double x_robot_m, double y_robot_m, const MatchField& field,
                                 const double pose[3], double hit_stddev_m, double residual[2],
                                 double* jacobian);

}  // namespace strata::registration
