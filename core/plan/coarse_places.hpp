// SPDX-License-Identifier: Apache-2.0
/// Where on a plan a map may lie, over all turns and shifts.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/geometry/pose2.hpp"
#include "core/plan/wall_faces.hpp"

namespace strata::plan {

struct CoarsePlace {
  Pose2 plan_from_map;  ///< of a map whose origin is the middle of its faces
  double score = 0.0;   ///< share of the map's faces near a drawn one that looks the same way
};

/// What is known already: only places whose middle is nearer than that are looked at.
struct CoarseGuess {
  Pose2 plan_from_map;
  double radius_m = 3.0;
  double radius_rad = 0.5;
};

/// Mean of the faces.
[[nodiscard]] Eigen::Vector2d middle_of(const std::vector<WallFace>& faces);

/// The best `count` places that are 1 m or 10 degrees apart, the best first; all turns and shifts
/// on a lattice of 0.2 m, or more for what is larger than 32 m, are tried. Deterministic. O(turns x
/// faces x cells of the plan), faces: at most 800.
[[nodiscard]] std::vector<CoarsePlace> coarse_places(const std::vector<WallFace>& seen,
                                                     const std::vector<WallFace>& drawn,
                                                     std::size_t count,
                                                     const std::optional<CoarseGuess>& guess = {});

}  // namespace strata::plan
