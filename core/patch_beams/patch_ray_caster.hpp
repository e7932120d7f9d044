// SPDX-License-Identifier: Apache-2.0
/// Where beams may end in a map of which some parts are in one of several configurations.
#pragma once

#include <cstdint>
#include <set>
#include <span>
#include <vector>

#include "core/grid/grid.hpp"
#include "core/patch/patch_map.hpp"
#include "core/rays/ray_boxes.hpp"
#include "core/rays/ray_caster.hpp"
#include "core/rays/ray_kernel.hpp"

namespace strata::patch_beams {

/// Where a ray may end: at `range_m`, for the configurations `mask` of a sub-map.
struct RayEvent {
  std::int32_t submap = -1;  ///< -1: the static map, where every remaining beam ends
  std::uint64_t mask = 0;    ///< configurations whose first obstacle on the ray this is
  double range_m = 0.0;
};

/// A sub-map and those of its configurations in which a cell is an obstacle.
struct CellOwner {
  std::int32_t submap = -1;
  std::uint64_t mask = 0;
};

/// All first obstacles of all configurations along a ray, near ones first. Cells that end every ray
/// and those that end it in some configurations only are kept apart: most rays come near the first
/// kind alone.
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

  /// Whether the base map, or a configuration of a sub-map there, says anything of the cell that a
  /// point lies in.
  [[nodiscard]] bool knows(const Eigen::Vector2d& point_m) const {
    return known_.get(known_.cell_at(point_m)) != 0;
  }
  /// Whether an obstacle of the base map, or of any configuration, lies within `distance_m` of a
  /// point; see RayWalker.
  [[nodiscard]] bool is_near_surface(const Eigen::Vector2d& point_m, double distance_m) const {
    return static_.is_near(point_m, distance_m) || changing_.is_near(point_m, distance_m);
  }

  /// For kernels that cast rays to the first cell that ends every ray.
  [[nodiscard]] rays::RayTable static_table() const { return static_.table(); }
  /// Many rays at once to the first cell that is an obstacle in some configurations, as cast_batch.
  void cast_changing(const rays::RayBatch& batch, double* range_m, std::int32_t* mark) const {
    rays::cast_batch(changing_.table(), batch, range_m, mark);
  }
  [[nodiscard]] rays::RayTable changing_table() const { return changing_.table(); }
  /// Where such cells are, at most one box a sub-map.
  [[nodiscard]] const std::vector<rays::RayBox>& boxes() const { return boxes_; }
  /// The part of one of boxes() where cells are an obstacle in some configurations for a particle
  /// in `current`: cells of other sub-maps that its own overlaps are its own's.
  [[nodiscard]] const rays::RayBox& seen(const rays::RayBox& box, int current) const {
    return content(box, current).box;
  }
  /// Which configurations there are cells of in one of boxes(), each sub-map once, seen by a
  /// particle in `current`.
  [[nodiscard]] std::span<const CellOwner> owners_in(const rays::RayBox& box, int current) const {
    return content(box, current).owners;
  }
  /// Whether all cells in and at seen(box), those of other boxes too, are of one sub-map and in the
  /// same configurations: then a ray that has met one of them learns nothing from the others. But
  /// for cells of mark hidden_in(), or where that is below 0 of any mark but -hidden_in(): those
  /// are none for such a particle.
  [[nodiscard]] bool is_uniform(const rays::RayBox& box, int current) const {
    return content(box, current).is_uniform;
  }
  [[nodiscard]] std::int32_t hidden_in(const rays::RayBox& box, int current) const {
    return content(box, current).hidden;
  }
  /// Whether any of them counts, as below.
  [[nodiscard]] bool may_end_beams(const rays::RayBox& box, int current, int fixed) const;
  /// The configurations of a sub-map that count when `current` is known to be in `fixed`; -1: it is
  /// not known.
  [[nodiscard]] static std::uint64_t counting(std::int32_t submap, int current, int fixed) {
    if (submap != current || fixed < 0) return ~std::uint64_t{0};
    return std::uint64_t{1} << fixed;
  }
  /// Whose cells of this mark are, seen by a particle in `current`.
  [[nodiscard]] CellOwner owner(std::int32_t mark, int current) const {
    const auto place = static_cast<std::size_t>(mark);
    for (std::size_t n = begins_[place]; n < begins_[place + 1]; ++n) {
      if (owners_[n].submap == current) return owners_[n];
    }
    return owners_[begins_[place]];
  }
  /// The mask of all configurations of a sub-map.
  [[nodiscard]] std::uint64_t all(std::int32_t submap) const {
    return all_[static_cast<std::size_t>(submap)];
  }

 private:
  [[nodiscard]] Grid<std::int32_t> mark_cells(const patch::PatchMap& map, const CellRect& rect,
                                              Grid<std::uint8_t>& fixed);

  /// Of which configurations there are cells in a box, each sub-map once, for particles in
  /// `current`; -1: for those in none that owns some of them.
  struct BoxContent {
    std::int32_t current = -1;
    std::vector<CellOwner> owners;
    rays::RayBox box;
    bool is_uniform = false;
    std::int32_t hidden = 0;
    void add(std::int32_t submap, std::uint64_t mask);
  };
  [[nodiscard]] const BoxContent& content(const rays::RayBox& box, int current) const {
    const std::vector<BoxContent>& contents = contents_[box.number];
    for (std::size_t n = 1; n < contents.size(); ++n) {
      if (contents[n].current == current) return contents[n];
    }
    return contents.front();
  }
  void find_uniform(const CellRect& rect, const Grid<std::int32_t>& marks,
                    BoxContent& content) const;
  [[nodiscard]] CellRect seen_by(int current, const CellRect& rect,
                                 const Grid<std::int32_t>& marks) const;
  [[nodiscard]] std::vector<BoxContent> contents_of(const std::set<std::int32_t>& marks) const;

  rays::RayWalker static_;
  Grid<std::uint8_t> known_;
  rays::RayWalker changing_;
  std::vector<CellOwner> owners_;
  std::vector<std::size_t> begins_;  // of a mark's owners in owners_; one more at the end
  std::vector<std::uint64_t> all_;
  std::vector<rays::RayBox> boxes_;
  std::vector<std::vector<BoxContent>> contents_;  // of each box
};

}  // namespace strata::patch_beams
