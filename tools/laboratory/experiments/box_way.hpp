// SPDX-License-Identifier: Apache-2.0
/// A robot's way through one changeable area, and what it believes of it: figures 1.14 and 1.15 of
/// [stachniss2003chapter].
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/patch/patch_map.hpp"

namespace strata::experiments {

/// One scan on the way.
struct WayPoint {
  double time_s = 0.0;  ///< since the first scan of the day
  Pose2 found;
  Pose2 truth;
  std::vector<double> probability;  ///< of each configuration of the sub-map
};

/// The first way through the sub-map, from 3 s before it is entered to 3 s after it is left.
struct WayThrough {
  patch::PatchMap map;
  std::size_t submap = 0;
  std::size_t true_configuration = 0;
  std::vector<WayPoint> points;
  std::size_t entered = 0;  ///< index of the first point within the entry margin of the sub-map
  std::size_t left = 0;     ///< ... and of the last

  /// Of the true configuration.
  [[nodiscard]] double probability(std::size_t point) const {
    return points[point].probability[true_configuration];
  }
  /// Mean distance of the found from the true poses, from entering to leaving.
  [[nodiscard]] double error_m() const;
};

/// The first sub-map that the robot of the last day passes and whose state it knows, with one of
/// the patch models of patch_models.hpp and a scanner of a beam a degree all round; learned on the
/// other days. Nothing where there is none, or the robot does not leave it again. scenario:
/// corridor_box.yaml.
[[nodiscard]] std::optional<WayThrough> way_through_box(const std::string& scenario,
                                                        std::uint64_t seed,
                                                        const std::string& model);

}  // namespace strata::experiments
