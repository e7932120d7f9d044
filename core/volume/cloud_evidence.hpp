// SPDX-License-Identifier: Apache-2.0
/// Which voxels one cloud saw occupied and which free, for learners that count clouds.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/parallel.hpp"
#include "core/volume/brick_map.hpp"
#include "core/volume/cloud_in_map.hpp"
#include "core/volume/cloud_marks.hpp"

namespace strata::volume {

/// A bit a voxel, in the order of `place_in_brick`.
using BrickBits = std::array<std::uint64_t, 8>;

/// Stricter than what VolumeMap enters: a ray that comes in flat runs along a surface before it
/// ends, through voxels that noise ends other rays in, which would look as if they came and went.
/// So the last tenth of a ray says nothing (a scanner at height h looks onto a floor from range r
/// at the angle h / r: it is within an edge e of the floor for r e / h; with e = 0.1 m and
/// h = 1 m that is a tenth), nor does passing beside a voxel in which the same cloud ended.
class CloudEvidence {
 public:
  static constexpr float kTailShare = 0.1F;

  /// Replaces what was seen before. is_dynamic: as of VolumeMap::insert. The same for any number of
  /// threads. Throws InputError when a pose is not finite. O(voxels that rays pass).
  void see(const Cloud& cloud, std::span<const std::uint8_t> is_dynamic,
           const VoxelLattice& lattice, const RayLimits& limits, WorkerPool& pool);

  /// A voxel is ended in, passed, or neither. In no certain order.
  [[nodiscard]] const BrickMap<BrickMarks>& bricks() const { return seen_; }
  /// Where the cloud was seen from, in the map frame: halfway of its sweep. After `see`.
  [[nodiscard]] const Eigen::Vector3f& origin_m() const {
    return in_map_.origins[in_map_.origins.size() / 2].origin_m;
  }

 private:
  void see_ends(const Cloud& cloud, std::span<const std::uint8_t> is_dynamic,
                const VoxelLattice& lattice, const RayLimits& limits);
  void see_passed(const VoxelLattice& lattice, const RayLimits& limits, WorkerPool& pool);
  void find_near();
  void add_neighbours(const VoxelKey& key);

  CloudInMap in_map_;
  CloudMarks marks_;
  BrickMap<BrickMarks> seen_;
  BrickMap<BrickBits> near_;  ///< voxels about those in which the cloud ended
  std::vector<std::uint8_t> no_ends_;
};

/// Calls visit(place) for each bit that is set, in order.
template <typename Visit>
void for_each_place(const BrickBits& bits, Visit&& visit) {
  for (std::size_t word = 0; word < bits.size(); ++word) {
    for (std::uint64_t left = bits[word]; left != 0; left &= left - 1) {
      visit(static_cast<unsigned>(64 * word) + static_cast<unsigned>(std::countr_zero(left)));
    }
  }
}
inline void set_place(BrickBits& bits, unsigned place) {
  bits[place >> 6] |= std::uint64_t{1} << (place & 63U);
}

}  // namespace strata::volume
