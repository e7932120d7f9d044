// SPDX-License-Identifier: Apache-2.0
/// A map that a visit is told relative to: as it was learned, and then as the visit has shown it so
/// far, so that what is new costs bits where it is first seen.
#pragma once

#include <cstddef>
#include <cstdint>

#include <Eigen/Core>

#include "core/grid/grid.hpp"
#include "core/grid/reflection_grid.hpp"
#include "memory/store/detail/plain_math.hpp"

namespace strata::memory::detail {

/// No surface within reach.
inline constexpr int kNothing_cm = -1;

/// What lies on a ray.
struct RayAhead {
  int first_cm = kNothing_cm;   ///< to the first surface
  int second_cm = kNothing_cm;  ///< ... and to the first one behind it
  int certainty = 0;            ///< of the first: 0 to 5
  int unknown = 0;              ///< cells before it that nobody saw
  std::size_t cell = 0;         ///< of the first
};

/// Where a ray begins, its direction, and what a scanner may measure there.
struct Ray {
  Eigen::Vector2d from_m;
  PlainDirection direction;
  int least_cm = 0;
  int most_cm = 0;
};

/// The same bits on every machine.
class LiveMap {
 public:
  explicit LiveMap(const ReflectionGrid& map);

  [[nodiscard]] double resolution_m() const { return cells_.resolution_m(); }
  /// O(cells on the ray).
  [[nodiscard]] RayAhead look(const Ray& ray) const;
  /// The first surface was there, or nothing came back from it.
  void confirm(const RayAhead& ahead);
  void weaken(const RayAhead& ahead);
  /// A beam went that far and ended there.
  void see(const Ray& ray, int range_cm);

 private:
  Grid<std::int8_t> cells_;  ///< above 0: a surface; 0: unknown; below: free
};

}  // namespace strata::memory::detail
