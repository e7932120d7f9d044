// SPDX-License-Identifier: Apache-2.0
/// Values on the voxels of space, kept in bricks of 8 x 8 x 8 that exist where something was seen.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "core/volume/voxel.hpp"

namespace strata::volume {

inline constexpr int kBrickEdge = 8;
inline constexpr std::size_t kBrickVoxels = 512;

/// Which brick a voxel is in: 13 bits an axis.
[[nodiscard]] inline std::uint64_t brick_id(const VoxelKey& key) {
  return static_cast<std::uint64_t>(key.x >> 3) | static_cast<std::uint64_t>(key.y >> 3) << 13 |
         static_cast<std::uint64_t>(key.z >> 3) << 26;
}
/// The lowest corner of a brick.
[[nodiscard]] inline VoxelKey brick_corner(std::uint64_t id) {
  return {static_cast<std::int32_t>(id & 0x1FFF) << 3,
          static_cast<std::int32_t>(id >> 13 & 0x1FFF) << 3,
          static_cast<std::int32_t>(id >> 26 & 0x1FFF) << 3};
}

namespace detail {
/// Bit i of n moved to bit 3 i.
[[nodiscard]] constexpr std::uint64_t spread_bits(std::uint64_t n) {
  std::uint64_t spread = 0;
  for (int bit = 0; bit < 16; ++bit) spread |= (n >> bit & 1U) << (3 * bit);
  return spread;
}
inline constexpr std::array<std::uint16_t, 8> kSpread{0, 1, 8, 9, 64, 65, 72, 73};
}  // namespace detail

/// Place of a voxel in its brick in Z-order, x lowest: bits 0 to 2 are the octree's last level, as
/// OctoMap numbers children.
[[nodiscard]] inline unsigned place_in_brick(const VoxelKey& key) {
  return static_cast<unsigned>(detail::kSpread[static_cast<std::size_t>(key.x & 7)]) |
         static_cast<unsigned>(detail::kSpread[static_cast<std::size_t>(key.y & 7)]) << 1 |
         static_cast<unsigned>(detail::kSpread[static_cast<std::size_t>(key.z & 7)]) << 2;
}
[[nodiscard]] inline VoxelKey voxel_of(std::uint64_t brick, unsigned place) {
  const auto gather = [place](unsigned first) {
    return static_cast<std::int32_t>((place >> first & 1U) | (place >> (first + 3) & 1U) << 1 |
                                     (place >> (first + 6) & 1U) << 2);
  };
  VoxelKey key = brick_corner(brick);
  key.x += gather(0);
  key.y += gather(1);
  key.z += gather(2);
  return key;
}
/// Z-order of bricks: the order of an octree's leaves.
[[nodiscard]] inline std::uint64_t brick_order(std::uint64_t id) {
  return detail::spread_bits(id & 0x1FFF) | detail::spread_bits(id >> 13 & 0x1FFF) << 1 |
         detail::spread_bits(id >> 26 & 0x1FFF) << 2;
}

/// A hash table from bricks to T, in the order in which they were first touched.
template <typename T>
class BrickMap {
 public:
  [[nodiscard]] std::size_t size() const { return ids_.size(); }
  [[nodiscard]] const std::vector<std::uint64_t>& ids() const { return ids_; }
  [[nodiscard]] T& value(std::size_t index) { return values_[index]; }
  [[nodiscard]] const T& value(std::size_t index) const { return values_[index]; }

  /// The brick's value, made when missing. References live until the next call.
  T& touch(std::uint64_t id) {
    if (2 * (ids_.size() + 1) > slots_.size()) grow();
    std::size_t slot = first_slot(id);
    for (; slots_[slot] != kEmpty; slot = (slot + 1) & (slots_.size() - 1)) {
      if (ids_[slots_[slot]] == id) return values_[slots_[slot]];
    }
    slots_[slot] = static_cast<std::uint32_t>(ids_.size());
    ids_.push_back(id);
    return values_.emplace_back();
  }
  /// Null when the brick was never touched.
  [[nodiscard]] const T* find(std::uint64_t id) const {
    if (slots_.empty()) return nullptr;
    for (std::size_t slot = first_slot(id); slots_[slot] != kEmpty;
         slot = (slot + 1) & (slots_.size() - 1)) {
      if (ids_[slots_[slot]] == id) return &values_[slots_[slot]];
    }
    return nullptr;
  }
  /// Forgets all bricks, keeps the memory.
  void clear() {
    ids_.clear();
    values_.clear();
    std::fill(slots_.begin(), slots_.end(), kEmpty);
  }
  /// Places of the bricks in Z-order, whatever the order they were touched in. O(n log n).
  [[nodiscard]] std::vector<std::size_t> in_order() const {
    std::vector<std::uint64_t> orders(size());
    std::transform(ids_.begin(), ids_.end(), orders.begin(), brick_order);
    std::vector<std::size_t> places(size());
    std::iota(places.begin(), places.end(), std::size_t{0});
    std::sort(places.begin(), places.end(),
              [&](std::size_t a, std::size_t b) { return orders[a] < orders[b]; });
    return places;
  }
  [[nodiscard]] std::size_t bytes() const {
    return ids_.capacity() * sizeof(std::uint64_t) + values_.capacity() * sizeof(T) +
           slots_.capacity() * sizeof(std::uint32_t);
  }

 private:
  static constexpr std::uint32_t kEmpty = 0xFFFFFFFFU;

  [[nodiscard]] std::size_t first_slot(std::uint64_t id) const {
    return static_cast<std::size_t>((id * 0x9E3779B97F4A7C15ULL) >> 32) & (slots_.size() - 1);
  }
  void grow() {
    slots_.assign(std::max<std::size_t>(64, 2 * slots_.size()), kEmpty);
    for (std::size_t i = 0; i < ids_.size(); ++i) {
      std::size_t slot = first_slot(ids_[i]);
      while (slots_[slot] != kEmpty) slot = (slot + 1) & (slots_.size() - 1);
      slots_[slot] = static_cast<std::uint32_t>(i);
    }
  }

  std::vector<std::uint32_t> slots_;
  std::vector<std::uint64_t> ids_;
  std::vector<T> values_;
};

}  // namespace strata::volume
