// SPDX-License-Identifier: Apache-2.0
/// Registers local clouds to others [chen1992object]: docs/theory/topological_mapping.md, "Local
/// clouds".
#pragma once

#include <span>

#include <Eigen/Core>

#include "core/geometry/pose2.hpp"
#include "core/topology/config.hpp"
#include "core/topology/local_cloud.hpp"

namespace strata::topology {

/// What two local clouds say about their visits being at one landmark.
struct PlaceMatch {
  bool converged = false;
  Pose2 a_from_b;
  /// Of (x, y, theta) of a_from_b in frame a; singular where the place does not say (a corridor),
  /// zero when not converged.
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  /// Log likelihood of b's points given the same place, against points of some other place [nats].
  double gain = 0.0;
  double overlap = 0.0;  ///< share of b's points that lie on a surface of a
};

/// ln of exp(gain) against 1 + exp(gain - config.look_alike_gain): points of another place lie
/// anywhere, but for the few places that look just the same. About the gain where it is small,
/// never above the limit. Without it a look-alike outweighs any odometry, and a filter that draws
/// few topologies loses the truth before a loop has told the two apart.
[[nodiscard]] double gain_over_look_alikes(double gain, const CloudMatchConfig& config);

/// The best of the alignments found from every start; deterministic. Not converged (with the
/// config's failure gain) when the overlap stays too small, or a cloud has too few points.
/// The points of a cloud are correlated: information and gain count as if it had
/// config.effective_points. The surface's reach is to be
/// config.first_gate_m. O(starts x iterations x points).
[[nodiscard]] PlaceMatch match_clouds(const PlaceSurface& a, const LocalCloud& b,
                                      std::span<const Pose2> starts_a_from_b,
                                      const CloudMatchConfig& config);
/// The same for a cloud that is used once.
[[nodiscard]] PlaceMatch match_clouds(const LocalCloud& a, const LocalCloud& b,
                                      std::span<const Pose2> starts_a_from_b,
                                      const CloudMatchConfig& config);

}  // namespace strata::topology
