// SPDX-License-Identifier: Apache-2.0
/// Newton's method on the cost of one topology, from starts that may be bent far.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/topology/detail/terms.hpp"
#include "core/topology/location_gaussian.hpp"

namespace strata::topology::detail {

/// The least cost nearby, with the curvature there.
struct Optimum {
  std::vector<Pose2> poses;
  double cost = 0.0;
  std::shared_ptr<const LocationGaussian> gaussian;
};

/// Nothing when the cost does not converge within 200 steps, or nothing is curved there. before:
/// of a topology of one visit less, whose order of rows is taken over; or null.
[[nodiscard]] std::optional<Optimum> descend(const Terms& terms, const LocationPriorConfig& config,
                                             std::vector<Pose2> start,
                                             const LocationGaussian* before = nullptr);

/// The Gaussian at `poses`: with the curvature of the penalties, or without it where that makes the
/// information indefinite. Null when it is singular.
[[nodiscard]] std::shared_ptr<const LocationGaussian> gaussian_at(const Terms& terms,
                                                                  const LocationPriorConfig& config,
                                                                  std::span<const Pose2> poses);

}  // namespace strata::topology::detail
