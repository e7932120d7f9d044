// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/volume_truth.hpp"

#include <bit>

namespace strata::pipeline {
namespace {

bool voxel_is_occupied(const volume::VolumeMap& map, const volume::VoxelKey& key) {
  const auto log_odds = map.log_odds(map.lattice().center_m(key));
  return log_odds && map.is_occupied(*log_odds);
}

}  // namespace

void VolumeTruth::add(const volume::Cloud& cloud, WorkerPool& pool) {
  if (cloud.truly_moving.empty()) return;
  raw_.insert(cloud, {}, pool);
  still_.insert(cloud, cloud.truly_moving, pool);
  volume::CloudInMap in_map;
  volume::bring_into_map(cloud, pool, in_map);
  for (std::size_t i = 0; i < in_map.ends_m.size(); ++i) {
    const auto key = raw_.lattice().key_at(in_map.ends_m[i]);
    if (!key) continue;
    Ends& ends = ends_.touch(volume::brick_id(*key));
    const unsigned place = volume::place_in_brick(*key);
    auto& words = cloud.truly_moving[i] != 0 ? ends.moving : ends.still;
    words[place >> 6] |= std::uint64_t{1} << (place & 63U);
  }
}

std::optional<VolumeScore> VolumeTruth::score(const volume::VolumeMap& filtered) const {
  if (ends_.size() == 0) return std::nullopt;
  VolumeScore score;
  for (std::size_t i = 0; i < ends_.size(); ++i) {
    for (std::size_t word = 0; word < 8; ++word) {
      std::uint64_t alone = ends_.value(i).moving[word] & ~ends_.value(i).still[word];
      for (; alone != 0; alone &= alone - 1) {
        const auto bit = static_cast<unsigned>(std::countr_zero(alone));
        const auto key = volume::voxel_of(ends_.ids()[i], static_cast<unsigned>(64 * word) + bit);
        ++score.moving_voxels;
        if (!voxel_is_occupied(raw_, key)) continue;
        ++score.moving_made;
        score.moving_left += voxel_is_occupied(filtered, key) ? 1 : 0;
      }
    }
  }
  volume::for_each_voxel(still_, [&](const volume::VoxelKey& key) {
    ++score.static_voxels;
    score.static_lost += voxel_is_occupied(filtered, key) ? 0 : 1;
  });
  return score;
}

}  // namespace strata::pipeline
