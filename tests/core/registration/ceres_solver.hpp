// SPDX-License-Identifier: Apache-2.0
/// The matching cost as a Ceres problem: the same minimum must come out.
#pragma once

#include "core/geometry/pose2_gaussian.hpp"
#include "core/registration/match_field.hpp"
#include "core/registration/scan_matcher.hpp"
#include "core/scan/endpoints.hpp"

namespace strata::registration {

/// Where Ceres finds the least cost of `match`, coarse to fine, on one thread.
[[nodiscard]] Pose2 match_with_ceres(const Endpoints& endpoints, const MatchField& field,
                                     const Pose2& guess, const Pose2Gaussian& prior,
                                     const MatchConfig& config);

/// Residuals and Jacobian (row-major 2 x 3) of one beam at a pose, as the Ceres problem has them:
/// whitened distance across and along the nearest surface. False: nothing near.
[[nodiscard]] bool beam_residual(double x_robot_m, double y_robot_m, const MatchField& field,
                                 const double pose[3], double hit_stddev_m, double residual[2],
                                 double* jacobian);

}  // namespace strata::registration
