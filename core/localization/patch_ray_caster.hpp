// SPDX-License-Identifier: Apache-2.0
/// Where beams may end in a map of which some parts are in one of several configurations.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/localization/patch_states.hpp"
#include "core/localization/ray_caster.hpp"
#include "core/localization/ray_kernel.hpp"
#include "core/patch/patch_map.hpp"

namespace strata::localization {

/// Where a ray may end: at `range_m`, for the configurations `mask` of a sub-map.
struct RayEvent {
  std::int32_t submap = -1;  ///< -1: the static map, where every remaining beam ends
  std::uint64_t mask = 0;    ///< configurations whose first obstacle on the ray this is
  double range_m = 0.0;
};

/// All first obstacles of all configurations along a ray, near ones first.
class PatchRayCaster {
 public:
  /// Occupied: is_occupied; unknown is transparent. The static map counts outside the rectangles.
  /// Throws InputError for grids of different resolution.
  explicit PatchRayCaster(const patch::PatchMap& map);

  /// Fills `events` (cleared first), in order of range. current: the sub-map of the particle, whose
  /// cells win where rectangles overlap; elsewhere the sub-map with the nearest centre does. Ends
  /// at the first static obstacle, or when all configurations of one sub-map have ended the ray.
  void events(double x_m, double y_m, double c, double s, double max_range_m, int current,
              std::vector<RayEvent>& events) const;

  /// Many rays at once to the first cell that is an obstacle in any configuration, as cast_rays.
  void cast(const RayFan& fan, double* range_m, std::int32_t* cell) const {
    cast_rays(walker_.table(), fan, range_m, cell);
  }
  /// Whether every ray that comes to such a cell ends there, whatever the configurations: it
  /// belongs to the static map, or is an obstacle in all configurations of all sub-maps that have
  /// it.
  [[nodiscard]] bool is_certain(std::int32_t cell) const {
    const std::int32_t first = first_owner_.values()[static_cast<std::size_t>(cell)];
    return first < 0 || owners_[static_cast<std::size_t>(first)].is_certain;
  }

 private:
  struct Owner {
    std::int32_t submap;
    std::uint64_t mask;
    bool is_last;
    bool is_certain;  // of the first: all owners of this cell have it in all configurations
  };
  RayWalker walker_;
  Grid<std::int32_t> first_owner_;  // place in owners_; -1: the static map
  std::vector<Owner> owners_;
  std::vector<std::uint64_t> all_;  // per sub-map: the mask of all its configurations
};

/// p(z) of one beam when sub-map s is in configuration k with probability belief[offset(s) + k],
/// independently of other sub-maps: the exact recursion of SPEC C4 over the events of its ray. Each
/// event counts with the probability that its configuration holds and no earlier event ended the
/// beam. fixed_submap >= 0: that one is known to be in fixed_patch. end_value: the value of a beam
/// that meets nothing. values[e] is what event e contributes. O(events^2).
[[nodiscard]] double mix_events(const std::vector<RayEvent>& events,
                                const std::vector<double>& values, double end_value,
                                const PatchStates& states, std::span<const float> belief,
                                int fixed_submap = -1, int fixed_patch = -1);

}  // namespace strata::localization
