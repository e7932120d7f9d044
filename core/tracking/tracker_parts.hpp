// SPDX-License-Identifier: Apache-2.0
// What the parts of Tracker share; only its own .cpp files see it.
#pragma once

#include <cstddef>

#include <Eigen/Core>

#include "core/geometry/pose2_gaussian.hpp"
#include "core/registration/scan_matcher.hpp"
#include "core/scan/endpoints.hpp"
#include "core/tracking/tracking_config.hpp"

namespace strata::slam {

/// Fewer end points than these lie on a map in many ways: one beam follows the next wall.
inline constexpr std::size_t kMinHits = 5;

/// odometry_step with the standard deviation of its position times `doubt`.
[[nodiscard]] Pose2Gaussian doubted_step(const Pose2& step, const OdometryNoiseConfig& noise,
                                         double doubt);

/// Whether a scan of that information leaves its position open in some direction.
[[nodiscard]] bool is_ambiguous(const Eigen::Matrix3d& information);

/// Whether it leaves the heading open: a round hall, wherever in it the robot is.
[[nodiscard]] bool is_heading_open(const Eigen::Matrix3d& information, const Endpoints& endpoints,
                                   const registration::MatchConfig& config);

/// A covariance of (x, y, theta) in axes turned by `turn`.
[[nodiscard]] Eigen::Matrix3d turned(const Eigen::Matrix3d& covariance, const Pose2& turn);

}  // namespace strata::slam
