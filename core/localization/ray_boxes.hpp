// SPDX-License-Identifier: Apache-2.0
/// Which rays of a fan cross some boxes, with the widest SIMD that the machine has.
#pragma once

#include <cstddef>

#include "core/localization/ray_kernel.hpp"

namespace strata::localization {

/// A rectangle in the map, or relative to where rays start.
struct RayBox {
  double min_x_m = 0.0;
  double min_y_m = 0.0;
  double max_x_m = 0.0;
  double max_y_m = 0.0;
  std::size_t number = 0;  ///< to tell it from others
  double near_m = 0.0;     ///< no ray comes to it before this
};

/// Where rays of a fan cross boxes; columns with room for fan.count + kSlack entries.
struct RayCrossings {
  static constexpr std::size_t kSlack = 8;
  double* ray = nullptr;     ///< number in the fan
  double* cosine = nullptr;  ///< direction in the map
  double* sine = nullptr;
  double* from_m = nullptr;  ///< first entry into any of the boxes
  double* to_m = nullptr;    ///< last exit from any of them, not beyond the ray's end
  double* boxes = nullptr;   ///< which it crosses of the first kNamed: sum of 2^place
  static constexpr std::size_t kNamed = 52;
};

/// Fills `found` with the rays of `fan` that cross at least one box before end_m[k] (or the fan's
/// limit), in their order, and returns how many. The boxes are relative to (fan.x_m, fan.y_m).
std::size_t cross_boxes(const RayFan& fan, const double* end_m, const RayBox* boxes,
                        std::size_t box_count, const RayCrossings& found);

}  // namespace strata::localization
