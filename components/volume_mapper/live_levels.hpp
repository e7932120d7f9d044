// SPDX-License-Identifier: Apache-2.0
/// The time levels of the live 3-D map.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>

#include "components/volume_mapper/config.hpp"
#include "core/base/parallel.hpp"
#include "core/volume/voxel_memory.hpp"

namespace strata::volume_mapper {

/// A level and what it is called in topics and files.
inline constexpr std::array<std::pair<volume::VoxelLevel, const char*>, volume::kVoxelLevels>
    kLevels{{{volume::VoxelLevel::kShort, "short"},
             {volume::VoxelLevel::kMid, "mid"},
             {volume::VoxelLevel::kLong, "long"}}};

/// Voxels by level, of at most one cloud in level_period_s: what a level means shall not depend on
/// how many clouds a second a scanner gives.
class LiveLevels {
 public:
  /// Throws ConfigError.
  explicit LiveLevels(const VolumeMapperConfig& config);

  /// is_dynamic: as of VolumeMap::insert.
  void see(const volume::Cloud& cloud, std::span<const std::uint8_t> is_dynamic, WorkerPool& pool);
  [[nodiscard]] const volume::VoxelMemory& memory() const { return memory_; }

 private:
  double period_s_;
  std::optional<Stamp> last_;
  volume::VoxelMemory memory_;
};

}  // namespace strata::volume_mapper
