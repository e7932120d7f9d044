// SPDX-License-Identifier: Apache-2.0
/// Topologies with weights, before the filter keeps some of them.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "core/topology/topology_filter.hpp"

namespace strata::topology {

/// One topology with what only the filter needs of it.
struct Particle {
  Hypothesis hypothesis;
  std::vector<Eigen::Matrix3d> newest_covariances;  ///< of each visit when it was new
};

/// Indices, heaviest first, equal ones by their labels. log_weights: one a particle.
[[nodiscard]] std::vector<std::size_t> by_weight(const std::vector<Particle>& particles,
                                                 const std::vector<double>& log_weights);

}  // namespace strata::topology
