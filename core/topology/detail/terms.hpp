// SPDX-License-Identifier: Apache-2.0
/// The factors of one topology, sorted by kind, and the poses that fit them best.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/topology/detail/near_pairs.hpp"
#include "core/topology/evidence.hpp"

namespace strata::topology::detail {

/// A measured transform between two visits.
struct Link {
  std::size_t a = 0;
  std::size_t b = 0;
  Pose2 a_from_b;
  Eigen::Matrix3d information;  // may be singular
};

/// The factors of one topology, sorted by kind. Every pair of `landmarks` (their first visits)
/// repels each other as the config says.
struct Terms {
  std::vector<Link> links;
  std::vector<Pair> revisits;
  std::vector<std::size_t> landmarks;
  double log_constant = 0.0;
};

/// labels and measurements as for `evaluate`.
[[nodiscard]] Terms collect(const Labels& labels, const Measurements& measurements,
                            std::span<const ScanFactor> scans, const LocationPriorConfig& config);

/// Half the squared whitened errors plus the penalties.
[[nodiscard]] double cost_at(const Terms& terms, std::span<const Pose2> poses,
                             const LocationPriorConfig& config);
/// The same; near: of the terms' landmarks within the penalty's radius.
[[nodiscard]] double cost_at(const Terms& terms, std::span<const Pose2> poses,
                             const LocationPriorConfig& config, NearPairs& near);

/// Moves the poses to the least cost, the first one fixed, from anywhere; returns whether that
/// converged. Ceres; `descend` is faster where the start is good.
[[nodiscard]] bool optimize(const Terms& terms, const LocationPriorConfig& config,
                            std::vector<Pose2>& poses, double& cost);

}  // namespace strata::topology::detail
