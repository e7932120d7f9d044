// SPDX-License-Identifier: Apache-2.0
/// Whether two local maps can lie on each other: what one has on surface, the other must not have
/// seen as free.
#pragma once

#include <cstddef>

#include "core/registration/match_field.hpp"
#include "core/scan/endpoints.hpp"
#include "core/tracking/local_map.hpp"

namespace strata::slam {

/// How the points of one map lie in the space that another has seen.
struct Agreement {
  double overlap = 0.0;    ///< share of points that fall into space the other has seen
  double agreement = 0.0;  ///< of those, the share that falls on surface
};

/// From how many of `all` points fall on surface and into free space.
[[nodiscard]] Agreement agreement_of(std::size_t surface, std::size_t free, std::size_t all);

/// What the 3 x 3 cells about a point say: occupied when one of them is; unknown where the cell of
/// the point itself is.
[[nodiscard]] SurfaceState state_near(const StateGrid& states, const Eigen::Vector2d& point_m);

/// Of points with a space: state_near at point_m(point) for each. O(points).
template <typename Points, typename PointM>
[[nodiscard]] Agreement agreement_with(const StateGrid& states, const Points& points,
                                       const PointM& point_m) {
  std::size_t surface = 0;
  std::size_t free = 0;
  for (const auto& point : points) {
    const SurfaceState state = state_near(states, point_m(point));
    surface += state == SurfaceState::kOccupied ? 1 : 0;
    free += state == SurfaceState::kFree ? 1 : 0;
  }
  return agreement_of(surface, free, points.size());
}

/// How far a view goes to all sides: root 2 times the standard deviation of its points along the
/// lesser of their two axes, which is their spread where both are alike. O(points).
[[nodiscard]] double breadth_m(const Endpoints& view);

/// A match field over the points of a local map, in its frame.
[[nodiscard]] registration::MatchField field_of(const LocalMap& local_map, double resolution_m,
                                                const registration::MatchFieldConfig& config);

}  // namespace strata::slam
