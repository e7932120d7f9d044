// SPDX-License-Identifier: Apache-2.0
/// The surfaces of a map that changes: those that are always there, and those that belong to
/// configurations of sub-maps.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/grid/reflection_grid.hpp"
#include "core/grid/surface_layer.hpp"
#include "core/localization/patch_states.hpp"
#include "core/patch/patch_map.hpp"
#include "core/registration/match_field.hpp"

namespace strata::refinement {

class SurfaceField {
 public:
  /// map: says which cells are occupied. patches: null for a map without changeable areas. Without
  /// a layer surfaces lie in the middle of their cells. O(cells + surfaces).
  SurfaceField(const ReflectionGrid& map, const SurfaceLayer& layer,
               const patch::PatchMap* patches);

  /// Takes up what is believed of the sub-maps: a surface that is there only in some configurations
  /// counts where those have `min_probability` together; beams that end by one of which less is
  /// known match nothing. O(surfaces that change).
  void believe(const std::vector<localization::SubmapBelief>& submaps, double min_probability);

  [[nodiscard]] const registration::MatchField& field() const { return field_; }
  /// How far surfaces may lie from where the field has them, as it knows no better [m].
  [[nodiscard]] double stddev_m() const { return stddev_m_; }
  [[nodiscard]] std::size_t changing() const { return changing_.size(); }

 private:
  /// A surface that is there in some configurations of a sub-map.
  struct Changing {
    std::size_t point;
    std::size_t submap;
    std::vector<bool> is_there;  // a configuration
  };
  void add_cell(const ReflectionGrid& map, const patch::PatchMap* patches,
                const SurfaceLayer& layer, std::size_t i);

  registration::MatchField field_;
  double stddev_m_ = 0.0;
  std::vector<Changing> changing_;
  std::size_t submap_count_ = 0;
  std::vector<const std::vector<double>*> beliefs_;  // scratch, a sub-map; null: nothing is known
};

}  // namespace strata::refinement
