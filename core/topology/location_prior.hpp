// SPDX-License-Identifier: Apache-2.0
/// Distinct landmarks do not usually lie close together [ranganathan2006rao, section III-C].
#pragma once

#include <cmath>

#include "core/topology/config.hpp"

namespace strata::topology {

/// Penalty of two distinct landmarks and its derivatives by their distance.
struct Penalty {
  double value = 0.0;  ///< [nats]
  double slope = 0.0;  ///< [nats/m]
  double curve = 0.0;  ///< [nats/m^2]
};

/// P (1 - 3u^2 + 2u^3) with u = distance / radius; nothing from the radius on. The paper points to
/// its reference for the polynomial; a cubic is chosen because it joins zero smoothly, where a
/// quadratic's kink would spoil the linearization that the evidence stands on. distance_m >= 0.
[[nodiscard]] inline Penalty penalty_at(double distance_m, const LocationPriorConfig& config) {
  const double u = distance_m / config.penalty_radius_m;
  if (u >= 1.0) return {};
  const double scale = config.max_penalty / config.penalty_radius_m;
  return {config.max_penalty * (1.0 - u * u * (3.0 - 2.0 * u)), -6.0 * scale * u * (1.0 - u),
          -6.0 * scale / config.penalty_radius_m * (1.0 - 2.0 * u)};
}

}  // namespace strata::topology
