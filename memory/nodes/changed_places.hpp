// SPDX-License-Identifier: Apache-2.0
/// Where two time levels disagree: what has changed since the slower one was true.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "memory/nodes/node_map.hpp"

namespace strata::memory {

enum class ChangeKind : std::uint8_t {
  kAppeared,  ///< a surface where the slower level sees free ground
  kVanished,  ///< free ground where the slower level has a surface
};

struct ChangedPlace {
  ChangeKind kind = ChangeKind::kAppeared;
  Eigen::Vector2d min_m;  ///< box around the surface, map frame
  Eigen::Vector2d max_m;
  std::size_t cells = 0;  ///< of the surface
  [[nodiscard]] Eigen::Vector2d center_m() const { return 0.5 * (min_m + max_m); }
};

struct ChangeConfig {
  double resolution_m = 0.05;
  /// A surface of the other level within this is the same one: nodes differ a little about it.
  double same_within_m = 0.25;
  /// Smaller changes are taken for noise.
  double min_length_m = 0.25;
};

/// Surfaces of one level that the other contradicts, joined over gaps of one cell; largest first.
/// Ground that either level does not know is no change. O(nodes x cells within max_range_m).
[[nodiscard]] std::vector<ChangedPlace> changed_places(const NodeMap& map, int slower_level,
                                                       int faster_level,
                                                       const ChangeConfig& config = {});

}  // namespace strata::memory
