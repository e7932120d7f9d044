// SPDX-License-Identifier: Apache-2.0
/// The factors of one topology, sorted by kind, and the poses that fit them best.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/topology/evidence.hpp"

namespace strata::topology::detail {

/// A measured transform between two visits, whitened.
struct Link {
  std::size_t a = 0;
  std::size_t b = 0;
  Pose2 a_from_b;
  Eigen::Matrix3d whitener;  // whitener' * whitener = information
};

struct Pair {
  std::size_t a = 0;
  std::size_t b = 0;
};

/// The factors of one topology, sorted by kind.
struct Terms {
  std::vector<Link> links;
  std::vector<Pair> revisits;
  std::vector<Pair> penalties;
  double log_constant = 0.0;
};

/// labels and measurements as for `evaluate`; poses tell which landmarks are near enough to repel
/// each other.
[[nodiscard]] Terms collect(const Labels& labels, const Measurements& measurements,
                            std::span<const ScanFactor> scans, std::span<const Pose2> poses,
                            const LocationPriorConfig& config);

/// Moves the poses to the least cost (half the squared whitened errors plus the penalties), the
/// first one fixed; returns whether that converged.
[[nodiscard]] bool optimize(const Terms& terms, const LocationPriorConfig& config,
                            std::vector<Pose2>& poses, double& cost);

}  // namespace strata::topology::detail
