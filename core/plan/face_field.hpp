// SPDX-License-Identifier: Apache-2.0
/// The nearest face that looks the same way, in one look-up.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/plan/wall_faces.hpp"

namespace strata::plan {

/// By cell and direction. Memory: 32 bytes a cell.
class FaceField {
 public:
  /// O(faces x (radius / cell)^2).
  FaceField(std::vector<WallFace> faces, double cell_m, double radius_m);

  [[nodiscard]] const std::vector<WallFace>& faces() const { return faces_; }
  /// The face nearest to the middle of the cell at that point, of those that look about the same
  /// way (within 45 to 68 degrees); null when none lies within the radius. O(1).
  [[nodiscard]] const WallFace* nearest(const Eigen::Vector2d& at_m,
                                        const Eigen::Vector2d& normal) const;

 private:
  std::vector<WallFace> faces_;
  std::array<Grid<std::int32_t>, kDirections> nearest_;  // index into faces_, -1: none
};

}  // namespace strata::plan
