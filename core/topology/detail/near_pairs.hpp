// SPDX-License-Identifier: Apache-2.0
/// Landmarks near each other, of thousands.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/geometry/pose2.hpp"

namespace strata::topology::detail {

/// Two visits, a before b.
struct Pair {
  std::size_t a = 0;
  std::size_t b = 0;
};

/// Pairs of `landmarks` (ascending indices of poses) nearer to each other than reach_m, by b and
/// then by a. A landmark that is not finite is near none. O(landmarks log landmarks + landmarks x
/// those beside them).
[[nodiscard]] std::vector<Pair> near_pairs(std::span<const std::size_t> landmarks,
                                           std::span<const Pose2> poses, double reach_m);

/// The same for poses that move little from one call to the next: those that may come near are
/// looked for again only once a landmark has moved by a tenth of the reach.
class NearPairs {
 public:
  /// Keeps a reference to the landmarks.
  NearPairs(std::span<const std::size_t> landmarks, double reach_m);
  /// Equal to near_pairs; holds until the next call. O(landmarks + pairs) where little has moved.
  [[nodiscard]] std::span<const Pair> at(std::span<const Pose2> poses);

 private:
  [[nodiscard]] bool have_moved(std::span<const Pose2> poses) const;
  std::span<const std::size_t> landmarks_;
  double reach_m_;
  std::vector<Eigen::Vector2d> looked_from_;  // positions of the landmarks then
  std::vector<Pair> candidates_;
  std::vector<Pair> near_;
};

}  // namespace strata::topology::detail
