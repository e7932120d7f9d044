// SPDX-License-Identifier: Apache-2.0
/// Voxels: places on OctoMap's lattice of 2^16 cells an axis, centred on the map's origin.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include <Eigen/Core>

namespace strata::volume {

/// A voxel's place along x, y, z, each in [0, 2^16).
struct VoxelKey {
  std::int32_t x = 0;
  std::int32_t y = 0;
  std::int32_t z = 0;
  friend bool operator==(const VoxelKey&, const VoxelKey&) = default;
  friend auto operator<=>(const VoxelKey&, const VoxelKey&) = default;
};

inline constexpr int kLatticeDepth = 16;
inline constexpr std::int32_t kLatticeMiddle = 1 << (kLatticeDepth - 1);

/// Between points of the map frame and voxels, with OctoMap's arithmetic [hornung2013octomap], so
/// that its trees and ours hold the same voxels.
class VoxelLattice {
 public:
  explicit VoxelLattice(double resolution_m)
      : resolution_m_(resolution_m), per_metre_(1.0 / resolution_m) {}

  [[nodiscard]] double resolution_m() const { return resolution_m_; }

  /// Nothing outside the lattice and for numbers that are not finite.
  [[nodiscard]] std::optional<VoxelKey> key_at(const Eigen::Vector3f& point_m) const {
    std::array<double, 3> scaled{};
    for (int i = 0; i < 3; ++i) {
      scaled[static_cast<std::size_t>(i)] =
          std::floor(per_metre_ * static_cast<double>(point_m[i]));
    }
    for (const double value : scaled) {
      if (!(value >= -kLatticeMiddle && value < kLatticeMiddle)) return std::nullopt;
    }
    return VoxelKey{static_cast<std::int32_t>(scaled[0]) + kLatticeMiddle,
                    static_cast<std::int32_t>(scaled[1]) + kLatticeMiddle,
                    static_cast<std::int32_t>(scaled[2]) + kLatticeMiddle};
  }
  /// Middle of a voxel along one axis [m].
  [[nodiscard]] double center_m(std::int32_t key) const {
    return (static_cast<double>(key - kLatticeMiddle) + 0.5) * resolution_m_;
  }
  [[nodiscard]] Eigen::Vector3d center_m(const VoxelKey& key) const {
    return {center_m(key.x), center_m(key.y), center_m(key.z)};
  }

 private:
  double resolution_m_;
  double per_metre_;
};

/// Voxels from min to max, both inside.
struct VoxelBox {
  VoxelKey min{0, 0, 0};
  VoxelKey max{2 * kLatticeMiddle - 1, 2 * kLatticeMiddle - 1, 2 * kLatticeMiddle - 1};

  [[nodiscard]] bool contains(const VoxelKey& key) const {
    return key.x >= min.x && key.x <= max.x && key.y >= min.y && key.y <= max.y && key.z >= min.z &&
           key.z <= max.z;
  }
  [[nodiscard]] bool is_everything() const { return *this == VoxelBox{}; }
  friend bool operator==(const VoxelBox&, const VoxelBox&) = default;
};

}  // namespace strata::volume
