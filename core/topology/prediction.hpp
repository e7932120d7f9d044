// SPDX-License-Identifier: Apache-2.0
/// What a topology expects of the next visit, in closed form from the Gaussian that it carries.
#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "core/topology/evidence.hpp"
#include "core/topology/location_gaussian.hpp"

namespace strata::topology {

/// One Gaussian factor between an older visit and the newest one, linearized.
struct LinearizedFactor {
  std::size_t visit = 0;
  Eigen::Vector3d error = Eigen::Vector3d::Zero();  ///< at the predicted poses
  Eigen::Matrix3d by_visit = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d by_newest = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  ///< may be singular
};

/// The posterior over the poses of n visits and of one more, that odometry leads to. Keeps
/// references; not thread-safe.
class Prediction {
 public:
  /// poses: the mean of the Gaussian, n of them.
  Prediction(std::span<const Pose2> poses, const LocationGaussian& gaussian,
             const OdometryFactor& odometry);

  [[nodiscard]] const Pose2& newest() const { return newest_; }
  /// Of the newest position less that of `visit`, in the map frame. As
  /// LocationGaussian::covariance_of the first time.
  [[nodiscard]] Eigen::Matrix2d covariance_apart(std::size_t visit);
  /// The same with `bound`, an upper bound of the covariance of `visit`. O(1).
  [[nodiscard]] Eigen::Matrix2d covariance_apart(std::size_t visit,
                                                 const Eigen::Matrix3d& bound) const;

  /// The two visits are at one place up to the config's standard deviation; their headings say
  /// nothing about each other.
  [[nodiscard]] LinearizedFactor same_place_factor(std::size_t visit,
                                                   const LocationPriorConfig& config) const;
  /// Their local clouds are registered to each other.
  [[nodiscard]] LinearizedFactor registration_factor(std::size_t visit,
                                                     const PlaceMatch& match) const;

  struct Conditioned {
    double log_factor = 0.0;   ///< ln of the mean of exp(-half the squared errors)
    std::vector<Pose2> poses;  ///< most probable then, of n + 1 visits
  };
  /// All factors at once; at most two. O(n + fill).
  [[nodiscard]] Conditioned conditioned_on(std::span<const LinearizedFactor> factors);

 private:
  [[nodiscard]] const Eigen::Matrix3d& covariance_between(std::size_t visit, std::size_t other);
  std::span<const Pose2> poses_;
  const LocationGaussian& gaussian_;
  Pose2 newest_;
  Eigen::MatrixX3d with_newest_;  // covariance of each of n + 1 poses with the newest
  Eigen::Matrix3d by_last_;       // of the newest pose by the one before
  std::map<std::pair<std::size_t, std::size_t>, Eigen::Matrix3d> between_;  // of older poses
};

}  // namespace strata::topology
