// SPDX-License-Identifier: Apache-2.0
/// How many beams of a scan are inliers of a map from one pose, and how much it says nothing of.
#pragma once

#include <concepts>

#include <Eigen/Core>

namespace strata::localization {

/// Shares of the beams in use. A beam is not judged when it may end where the map knows nothing and
/// meets no mapped obstacle on its way, nor when nothing returns to a laser in a place that the map
/// does not know: neither the pose nor the map is wrong for that. In space that was never mapped a
/// right pose would otherwise be called lost. All are 0 when no beam speaks.
///
/// The last three tell a wrong pose from a place where things stand otherwise. A thing taken away
/// lets beams go on to the next surface, a thing put there stops them before it; a wrong pose makes
/// them end anywhere. met <= at_surface <= judged - stopped, and inlier <= judged <= 1.
struct InlierShares {
  InlierShares() = default;
  /// Of a model that reads its map in one way only.
  InlierShares(double inlier_share, double judged_share)
      : inlier(inlier_share), judged(judged_share), met(inlier_share), at_surface(inlier_share) {}

  double inlier = 0.0;  ///< end where the model expects it
  double judged = 0.0;  ///< ... or elsewhere, though the map knows that place or what lies before
  double met = 0.0;     ///< end at the first obstacle on their way, or meet none as expected
  double at_surface = 0.0;  ///< ... or end near any surface of the map, whatever lies before it
  double stopped = 0.0;     ///< end at no surface, before the first one on their way

  /// The same over `count` beams: after sums over them.
  void divide_by(double count) {
    for (double* sum : {&inlier, &judged, &met, &at_surface, &stopped}) *sum /= count;
  }
  /// Of a scan of which these beams are that share, and the others are not judged.
  [[nodiscard]] InlierShares among_all(double share) const {
    InlierShares all = *this;
    for (double* of : {&all.inlier, &all.judged, &all.met, &all.at_surface, &all.stopped}) {
      *of *= share;
    }
    return all;
  }
};

/// Whatever says where it knows anything.
template <typename T>
concept LimitedMap = requires(const T& map, const Eigen::Vector2d& point_m) {
  { map.knows(point_m) } -> std::convertible_to<bool>;
};

/// Whatever also says where its surfaces are.
template <typename T>
concept SurfaceMap = requires(const T& map, const Eigen::Vector2d& point_m) {
  { map.is_near_surface(point_m, 0.1) } -> std::convertible_to<bool>;
};

/// Whether a map knows the place where a beam ends, and four more up to `tolerance_m` behind it:
/// with an obstacle there the beam would still be an inlier. Points in the map frame [m].
template <LimitedMap Map>
[[nodiscard]] bool knows_end(const Map& map, const Eigen::Vector2d& laser_m,
                             const Eigen::Vector2d& end_m, double tolerance_m) {
  constexpr int kSteps = 4;
  const double range_m = (end_m - laser_m).norm();
  const double step = range_m > 0.0 ? tolerance_m / (kSteps * range_m) : 0.0;
  for (int n = 0; n <= kSteps; ++n) {
    if (!map.knows(end_m + n * step * (end_m - laser_m))) return false;
  }
  return true;
}

}  // namespace strata::localization
