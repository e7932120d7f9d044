// SPDX-License-Identifier: Apache-2.0
#include "core/topology/evidence.hpp"

#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include <Eigen/LU>

#include "core/topology/detail/descent.hpp"
#include "core/topology/detail/terms.hpp"

namespace strata::topology {
namespace {

const double kLog2Pi = std::log(2.0 * std::numbers::pi);

std::optional<detail::Optimum> optimum_of(const detail::Terms& terms,
                                          const LocationPriorConfig& config,
                                          const std::vector<Pose2>& start,
                                          const LocationGaussian* before) {
  if (auto optimum = detail::descend(terms, config, start, before)) return optimum;
  detail::Optimum far{start, 0.0, nullptr};
  if (!detail::optimize(terms, config, far.poses, far.cost)) return std::nullopt;
  far.gaussian = detail::gaussian_at(terms, config, far.poses);
  if (!far.gaussian) return std::nullopt;
  return far;
}

}  // namespace

OdometryFactor::OdometryFactor(const Pose2Gaussian& way)
    : Pose2Gaussian(way),
      information(way.covariance.inverse()),
      log_normalizer(0.5 * (3.0 * kLog2Pi + std::log(way.covariance.determinant()))) {}

Evidence evaluate(const Labels& labels, const Measurements& measurements,
                  std::span<const ScanFactor> scans, const std::vector<Pose2>& start,
                  const LocationPriorConfig& config, const LocationGaussian* before) {
  Evidence evidence;
  evidence.poses = start;
  if (labels.size() < 2) {
    evidence.converged = true;
    evidence.gaussian = std::make_shared<const LocationGaussian>();
    return evidence;
  }
  const detail::Terms terms = detail::collect(labels, measurements, scans, config);
  std::optional<detail::Optimum> optimum = optimum_of(terms, config, start, before);
  if (!optimum) return evidence;
  evidence.converged = true;
  evidence.poses = std::move(optimum->poses);
  evidence.gaussian = std::move(optimum->gaussian);
  evidence.log_evidence = terms.log_constant - optimum->cost +
                          1.5 * static_cast<double>(labels.size() - 1) * kLog2Pi -
                          0.5 * evidence.gaussian->log_determinant();
  return evidence;
}

Eigen::Matrix3d marginal_covariance(const LocationGaussian& gaussian, std::size_t visit) {
  const Eigen::Matrix3d block = gaussian.covariance_of(visit);
  return 0.5 * (block + block.transpose());
}

std::vector<Eigen::Matrix3d> marginal_covariances(const LocationGaussian& gaussian) {
  std::vector<Eigen::Matrix3d> covariances;
  for (std::size_t i = 0; i < gaussian.visits(); ++i) {
    covariances.push_back(marginal_covariance(gaussian, i));
  }
  return covariances;
}

}  // namespace strata::topology
