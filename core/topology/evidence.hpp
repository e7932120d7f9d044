// SPDX-License-Identifier: Apache-2.0
/// How well a topology explains the measurements: the landmark locations integrated out
/// [ranganathan2006rao, (8), (12), (17)] (docs/theory/topological_mapping.md, "Evidence").
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/geometry/pose2_gaussian.hpp"
#include "core/topology/cloud_matcher.hpp"
#include "core/topology/config.hpp"
#include "core/topology/location_gaussian.hpp"
#include "core/topology/partition.hpp"

namespace strata::topology {

/// The way from one visit to the next: from_from_to with its covariance, (x, y, theta) in `from`.
/// What every topology needs of it is there once.
struct OdometryFactor : Pose2Gaussian {
  OdometryFactor(const Pose2Gaussian& way);  // NOLINT(google-explicit-constructor): it is one
  OdometryFactor(const Pose2& from_from_to, const Eigen::Matrix3d& its_covariance)
      : OdometryFactor(Pose2Gaussian{from_from_to, its_covariance}) {}
  Eigen::Matrix3d information;
  double log_normalizer = 0.0;  ///< -ln of the density at its mean
};

/// Two visits of one landmark whose local clouds were registered to each other.
struct ScanFactor {
  std::size_t from = 0;
  std::size_t to = 0;
  PlaceMatch match;  ///< a = from, b = to
};

/// Everything measured about n visits.
struct Measurements {
  std::span<const OdometryFactor> odometry;  ///< n - 1, between visit i and i + 1
  std::span<const double> log_new_density;   ///< n, of a new landmark's pose [1/(m^2 rad)]
};

struct Evidence {
  bool converged = false;
  double log_evidence = 0.0;
  /// Most probable pose of every visit in the frame of the first, map_from_robot.
  std::vector<Pose2> poses;
  /// The Gaussian around them. Null when not converged.
  std::shared_ptr<const LocationGaussian> gaussian;
};

/// ln of the integral over all poses but the first, which is the origin, of the product of
/// - the odometry, Gaussian, normalized;
/// - for a visit of a known landmark: its position Gaussian around that landmark's first visit,
///   its heading uniform, since a place is entered from any side;
/// - for a visit of a new landmark: a uniform density over the area, times exp(-penalty) for every
///   other landmark near it. The paper leaves the uniform density out; without it "new" and "known"
///   are not comparable;
/// - the scan factors: exp(gain) times a Gaussian factor, not normalized.
/// start: a first guess of the poses. labels: canonical, one a visit. The integral is
/// Laplace's, by Gauss and Newton's curvature, without that of the penalties where it makes the sum
/// indefinite: within 0.5 nats where links hold what was measured, 1.3 nats too much in the mean
/// where topologies are bent far (docs/theory/topological_mapping.md, section 5). Newton's method
/// from the start, and Ceres where that does not converge. before: of a topology of one visit less,
/// null for none: the order in which its poses are eliminated is taken over, which changes nothing
/// but rounding. O(n^1.5 x iterations) about.
[[nodiscard]] Evidence evaluate(const Labels& labels, const Measurements& measurements,
                                std::span<const ScanFactor> scans, const std::vector<Pose2>& start,
                                const LocationPriorConfig& config,
                                const LocationGaussian* before = nullptr);

/// The covariance of one visit's pose, symmetric. As LocationGaussian::covariance_of.
[[nodiscard]] Eigen::Matrix3d marginal_covariance(const LocationGaussian& gaussian,
                                                  std::size_t visit);
/// The covariance of every visit's pose. As n of them.
[[nodiscard]] std::vector<Eigen::Matrix3d> marginal_covariances(const LocationGaussian& gaussian);

}  // namespace strata::topology
