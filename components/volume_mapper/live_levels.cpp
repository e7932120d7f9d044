// SPDX-License-Identifier: Apache-2.0
#include "components/volume_mapper/live_levels.hpp"

#include <cmath>

namespace strata::volume_mapper {
namespace {

volume::VoxelMemoryConfig memory_config(const VolumeMapperConfig& config) {
  volume::VoxelMemoryConfig memory;
  memory.short_clouds = config.short_clouds;
  memory.mid_clouds = config.mid_clouds;
  memory.long_clouds = config.long_clouds;
  return memory;
}

}  // namespace

LiveLevels::LiveLevels(const VolumeMapperConfig& config)
    : period_s_(config.level_period_s),
      memory_(memory_config(config), volume::VoxelLattice(config.map.resolution_m),
              volume::ray_limits(config.map)) {}

void LiveLevels::see(const volume::Cloud& cloud, std::span<const std::uint8_t> is_dynamic,
                     WorkerPool& pool) {
  // Stamps may run backwards, as when a bag starts again.
  if (last_ && std::abs((cloud.stamp - *last_).seconds()) < period_s_) return;
  last_ = cloud.stamp;
  memory_.observe(cloud, is_dynamic, pool);
}

}  // namespace strata::volume_mapper
