// SPDX-License-Identifier: Apache-2.0
/// What stands where, by what is believed of the sub-maps now, and how likely that is to be
/// otherwise soon (docs/theory/habits.md, "Otherwise within a time").
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/grid/reflection_grid.hpp"
#include "core/patch/patch_map.hpp"

namespace strata::patch {

/// What the configurations of a sub-map share, one probability each; they sum to 1.
using Shares = std::vector<double>;

/// What is known of a sub-map to look ahead.
struct SubmapOutlook {
  Shares now;               ///< what is believed
  Shares usual;             ///< the stationary law of its chain
  double rate_per_s = 0.0;  ///< at which it is drawn anew from that
};

/// The probability that something with two states, which holds one now with the probability `now`
/// and usually with `usual` and is drawn anew from that at a rate, is at some time within the
/// horizon not in the state that is likelier now: 1 - b exp(-rate (1 - u) horizon), b >= 1/2 the
/// probability of that state now and u its usual one. In [0, 1]; of two as likely ones it is the
/// first that counts.
[[nodiscard]] double change_probability(double now, double usual, double rate_per_s,
                                        double horizon_s);

/// Cells of a patch map, and which configurations have something in each; made once, asked often.
class MapNow {
 public:
  /// Keeps no reference. Requires 1 to 64 configurations a sub-map. O(cells x configurations).
  explicit MapNow(const PatchMap& map);

  /// One a sub-map.
  [[nodiscard]] std::size_t submaps() const { return configurations_.size(); }
  /// Of each sub-map.
  [[nodiscard]] std::size_t configurations(std::size_t submap) const {
    return configurations_[submap];
  }

  /// P(a beam ends there: is_occupied) of each cell: 0 or 1 outside sub-maps, in [0, 1] in them;
  /// unknown where the configurations that know the cell have less than half of the belief. Where
  /// sub-maps overlap the rule of submaps_at. beliefs: one a sub-map. O(cells).
  [[nodiscard]] ReflectionGrid occupied(std::span<const Shares> beliefs) const;

  /// The change_probability of each cell that is occupied in some configurations and free in
  /// others, of what is believed within reach_m around it the greatest; 0 elsewhere. On the cells
  /// of occupied(). outlook: one a sub-map. O(cells + changing cells x cells in reach).
  [[nodiscard]] Grid<float> change(std::span<const SubmapOutlook> outlook, double horizon_s,
                                   double reach_m) const;

 private:
  struct AreaCell {
    std::size_t place = 0;  ///< in base_
    std::size_t submap = 0;
    std::uint64_t known = 0;     ///< the configurations that know it
    std::uint64_t occupied = 0;  ///< those of them in which it is
  };
  std::vector<std::size_t> configurations_;
  ReflectionGrid base_;  ///< 0, 1 or unknown
  std::vector<AreaCell> cells_;
};

}  // namespace strata::patch
