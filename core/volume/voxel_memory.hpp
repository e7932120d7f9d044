// SPDX-License-Identifier: Apache-2.0
/// What each voxel was like of late, for a while, and for long: timescale levels in space, after
/// those of nodes [kessler2010what] (docs/theory/static_3d.md, "Levels of voxels").
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "core/base/config.hpp"
#include "core/base/parallel.hpp"
#include "core/volume/brick_map.hpp"
#include "core/volume/cloud.hpp"
#include "core/volume/cloud_evidence.hpp"
#include "core/volume/volume_map.hpp"

namespace strata::volume {

enum class VoxelLevel : std::uint8_t { kShort = 0, kMid = 1, kLong = 2 };
inline constexpr std::size_t kVoxelLevels = 3;

struct VoxelMemoryConfig {
  double short_clouds = 2.0;
  double mid_clouds = 10.0;
  double long_clouds = 50.0;
  double min_change = 0.4;
  int min_voxels = 8;

  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("short_clouds", c.short_clouds,
            {.doc = "half-life of the short level, in clouds that saw the voxel", .min = 0.1});
    v.field("mid_clouds", c.mid_clouds, {.doc = "of the mid level", .min = 0.1});
    v.field("long_clouds", c.long_clouds, {.doc = "of the long level", .min = 0.1});
    v.renamed("least_change", "min_change");
    v.field("min_change", c.min_change,
            {.doc = "a voxel changed when its short and long level differ by this",
             .min = 0.01,
             .max = 1.0});
    v.renamed("least_voxels", "min_voxels");
    v.field("min_voxels", c.min_voxels,
            {.doc = "changes of fewer voxels that hang together are left out", .min = 1});
    v.require(c.short_clouds <= c.mid_clouds && c.mid_clouds <= c.long_clouds, "long_clouds",
              "is not the longest", "order them short, mid, long");
  }
};

/// Voxels that changed alike and hang together.
struct VolumeChange {
  bool appeared = false;  ///< else it is gone
  std::vector<VoxelKey> voxels;
  VoxelKey min;  ///< bounds, both inside
  VoxelKey max;
};

/// Three numbers a voxel: how often of late clouds ended in it rather than passed it. A level is
/// the mean of what was seen until it has seen as much as its half-life means, then forgets
/// exponentially: p += a (z - p), a = max(1 - 2^(-1/h), 1/n). Where Kessler's levels keep random
/// samples of ranges, a voxel knows two outcomes only, so that their share says all.
class VoxelMemory {
 public:
  /// Throws ConfigError.
  VoxelMemory(const VoxelMemoryConfig& config, const VoxelLattice& lattice,
              const RayLimits& limits);

  /// is_dynamic: as of VolumeMap::insert; such ends are not remembered, what moves is no change.
  /// The same for any number of threads. O(voxels passed).
  void observe(const Cloud& cloud, std::span<const std::uint8_t> is_dynamic, WorkerPool& pool);

  /// Share of clouds that ended in the voxel, by a level; nothing where none saw it.
  [[nodiscard]] std::optional<double> occupancy(const VoxelKey& key, VoxelLevel level) const;
  /// Every voxel that a cloud saw, with that share; in no certain order.
  void for_each_voxel(VoxelLevel level,
                      const std::function<void(const VoxelKey&, double)>& visit) const;
  [[nodiscard]] const VoxelLattice& lattice() const { return lattice_; }
  /// Where the short and the long level disagree, larger first. O(voxels).
  [[nodiscard]] std::vector<VolumeChange> changes() const;
  [[nodiscard]] std::size_t known_voxels() const;
  [[nodiscard]] std::size_t bytes() const { return bricks_.bytes(); }

 private:
  struct Brick {
    std::array<std::array<std::uint16_t, kBrickVoxels>, kVoxelLevels> share{};  ///< in 1 / 65535
    std::array<std::uint8_t, kBrickVoxels> seen{};  ///< clouds, up to 255
  };
  void learn(Brick& brick, const BrickBits& voxels, bool is_end) const;

  VoxelMemoryConfig config_;
  VoxelLattice lattice_;
  RayLimits limits_;
  std::array<double, kVoxelLevels> rates_{};
  CloudEvidence evidence_;  ///< of the present cloud
  BrickMap<Brick> bricks_;
};

}  // namespace strata::volume
