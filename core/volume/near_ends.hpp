// SPDX-License-Identifier: Apache-2.0
/// The voxels about those in which a cloud ended.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "core/volume/brick_map.hpp"
#include "core/volume/cloud_marks.hpp"

namespace strata::volume {

/// A bit a voxel, in the order of `place_in_brick`.
using BrickBits = std::array<std::uint64_t, 8>;

/// Rays that graze a floor pass through the voxels that its noise ends in, which would look as if
/// it came and went: voxels passed beside one in which the same cloud ended count as not seen.
class NearEnds {
 public:
  /// Replaces what was found before. O(ends).
  void find(const BrickMap<BrickMarks>& bricks) {
    near_.clear();
    for (std::size_t i = 0; i < bricks.size(); ++i) {
      for (std::size_t word = 0; word < 8; ++word) {
        for (std::uint64_t ended = bricks.value(i).ended[word]; ended != 0; ended &= ended - 1) {
          const auto bit = static_cast<unsigned>(std::countr_zero(ended));
          add_neighbours(voxel_of(bricks.ids()[i], static_cast<unsigned>(64 * word) + bit));
        }
      }
    }
  }
  /// Those of `passed` in brick `id` that are not beside an end.
  [[nodiscard]] BrickBits without(std::uint64_t id, BrickBits passed) const {
    if (const BrickBits* near = near_.find(id)) {
      for (std::size_t word = 0; word < 8; ++word) passed[word] &= ~(*near)[word];
    }
    return passed;
  }

 private:
  void add_neighbours(const VoxelKey& key) {
    for (std::int32_t z = key.z - 1; z <= key.z + 1; ++z) {
      for (std::int32_t y = key.y - 1; y <= key.y + 1; ++y) {
        for (std::int32_t x = key.x - 1; x <= key.x + 1; ++x) {
          const VoxelKey other{x, y, z};
          if (!VoxelBox{}.contains(other)) continue;
          const unsigned place = place_in_brick(other);
          near_.touch(brick_id(other))[place >> 6] |= std::uint64_t{1} << (place & 63U);
        }
      }
    }
  }
  BrickMap<BrickBits> near_;
};

}  // namespace strata::volume
