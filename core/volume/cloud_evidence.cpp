// SPDX-License-Identifier: Apache-2.0
#include "core/volume/cloud_evidence.hpp"

namespace strata::volume {

void CloudEvidence::see(const Cloud& cloud, std::span<const std::uint8_t> is_dynamic,
                        const VoxelLattice& lattice, const RayLimits& limits, WorkerPool& pool) {
  bring_into_map(cloud, pool, in_map_);
  seen_.clear();
  see_ends(cloud, is_dynamic, lattice, limits);
  find_near();
  see_passed(lattice, limits, pool);
}

void CloudEvidence::see_ends(const Cloud& cloud, std::span<const std::uint8_t> is_dynamic,
                             const VoxelLattice& lattice, const RayLimits& limits) {
  for (std::size_t i = 0; i < in_map_.ends_m.size(); ++i) {
    if (!is_dynamic.empty() && is_dynamic[i] != 0) continue;
    const auto range = static_cast<double>(cloud.points_m[i].norm());
    if (limits.max_range_m > 0.0 && range > limits.max_range_m) continue;
    const auto key = lattice.key_at(in_map_.ends_m[i]);
    if (!key || !limits.box.contains(*key)) continue;
    set_place(seen_.touch(brick_id(*key)).ended, place_in_brick(*key));
  }
}

void CloudEvidence::see_passed(const VoxelLattice& lattice, const RayLimits& limits,
                               WorkerPool& pool) {
  std::vector<Eigen::Vector3f>& ends = in_map_.ends_m;
  for (std::size_t part = 0; part < in_map_.origins.size(); ++part) {
    const RayOrigin& origin = in_map_.origins[part];
    const bool is_last = part + 1 == in_map_.origins.size();
    const std::size_t end = is_last ? ends.size() : in_map_.origins[part + 1].begin;
    for (std::size_t i = origin.begin; i < end; ++i) {
      ends[i] += kTailShare * (origin.origin_m - ends[i]);
    }
  }
  no_ends_.assign(ends.size(), 1);
  marks_.mark(in_map_.origins, ends, no_ends_, lattice, limits, pool);
  const BrickMap<BrickMarks>& passed = marks_.bricks();
  for (std::size_t i = 0; i < passed.size(); ++i) {
    const std::uint64_t id = passed.ids()[i];
    const BrickBits* near = near_.find(id);
    BrickMarks& seen = seen_.touch(id);
    for (std::size_t word = 0; word < seen.passed.size(); ++word) {
      const std::uint64_t beside = near == nullptr ? 0 : (*near)[word];
      seen.passed[word] = passed.value(i).passed[word] & ~beside;
    }
  }
}

void CloudEvidence::find_near() {
  near_.clear();
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    for_each_place(seen_.value(i).ended,
                   [&](unsigned place) { add_neighbours(voxel_of(seen_.ids()[i], place)); });
  }
}

void CloudEvidence::add_neighbours(const VoxelKey& key) {
  for (std::int32_t z = key.z - 1; z <= key.z + 1; ++z) {
    for (std::int32_t y = key.y - 1; y <= key.y + 1; ++y) {
      for (std::int32_t x = key.x - 1; x <= key.x + 1; ++x) {
        const VoxelKey other{x, y, z};
        if (!VoxelBox{}.contains(other)) continue;
        set_place(near_.touch(brick_id(other)), place_in_brick(other));
      }
    }
  }
}

}  // namespace strata::volume
