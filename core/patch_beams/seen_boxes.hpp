// SPDX-License-Identifier: Apache-2.0
/// The boxes with changing cells that are near a chunk of particles, as each of these sees them.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/localization/laser_columns.hpp"
#include "core/patch_beams/chunk.hpp"
#include "core/patch_beams/patch_ray_caster.hpp"
#include "core/rays/ray_boxes.hpp"

namespace strata::patch_beams {

/// Working memory: take(), then what was found. Allocates nothing once warm.
class SeenBoxes {
 public:
  /// The boxes of `caster` within max_range_m of any laser. One entry of `states` a laser.
  void take(const PatchRayCaster& caster, const localization::LaserColumns& lasers,
            const ChunkStates& states, double max_range_m);
  [[nodiscard]] bool empty() const { return ways_.empty(); }

  /// Those that a beam may cross, with this direction in its bundle, from any of the lasers. Valid
  /// until the next call.
  [[nodiscard]] std::span<const rays::BoxColumns> near_beam(double cosine, double sine);

  /// Whether BoxCrossings::boxes names all of them.
  [[nodiscard]] bool are_named() const { return ways_.size() <= rays::BoxCrossings::kNamed; }
  [[nodiscard]] std::size_t size() const { return ways_.size(); }
  /// Entries of each, one a laser.
  [[nodiscard]] std::size_t lasers() const { return lasers_; }
  /// What counts in a box for a particle; submap -1: several sub-maps do.
  [[nodiscard]] const CellOwner& content(std::size_t box, std::size_t n) const {
    return contents_[box * lasers_ + n];
  }
  /// Whether all cells of a box are alike, as PatchRayCaster::is_uniform, for each particle that it
  /// counts for.
  [[nodiscard]] bool is_uniform(std::size_t box) const { return ways_[box].is_uniform; }
  /// Whether a box counts for a particle.
  [[nodiscard]] bool counts(std::size_t box, std::size_t n) const {
    return std::isfinite(columns_[(box * kColumns + 4) * lasers_ + n]);
  }

 private:
  /// Where a box lies from the middle of the lasers.
  struct Way {
    double x = 0.0;  ///< direction to its middle
    double y = 0.0;
    double min_cosine = -1.0;  ///< of the angle between that and a beam of the first bundle
    bool is_uniform = true;    ///< for all that it counts for
  };
  void take_box(const PatchRayCaster& caster, const rays::RayBox& box,
                const localization::LaserColumns& lasers, const ChunkStates& states,
                double max_range_m);
  void name_boxes();
  bool place_box(const rays::RayBox& seen, const localization::LaserColumns& lasers,
                 std::size_t begin, std::size_t end, double max_range_m, double* column) const;

  std::size_t lasers_ = 0;
  double middle_x_m_ = 0.0;
  double middle_y_m_ = 0.0;
  double radius_m_ = 0.0;  ///< about the middle, lasers lie within it
  double heading_cosine_ = 1.0;
  double heading_sine_ = 0.0;
  double spread_cosine_ = 1.0;       ///< of the largest angle between the first heading and another
  std::vector<double> columns_;      ///< kColumns rows a box, of one entry a laser
  std::vector<CellOwner> contents_;  // as many entries a box
  std::vector<Way> ways_;
  std::vector<rays::BoxColumns> boxes_;  // one of each
  std::vector<rays::BoxColumns> near_;
  static constexpr std::size_t kColumns = 6;
};

}  // namespace strata::patch_beams
