// SPDX-License-Identifier: Apache-2.0
#include "core/volume/voxel_filter.hpp"

#include <algorithm>
#include <limits>

#include "core/volume/cloud_in_map.hpp"

namespace strata::volume {
namespace {

void add_marks(const BrickBits& marks, std::array<std::uint16_t, kBrickVoxels>& to) {
  for_each_place(marks, [&](unsigned place) {
    if (to[place] < std::numeric_limits<std::uint16_t>::max()) ++to[place];
  });
}

}  // namespace

VoxelFilter::VoxelFilter(const VoxelFilterConfig& config, const VoxelLattice& lattice,
                         const RayLimits& limits)
    : config_(config), lattice_(lattice), limits_(limits) {
  require_valid(config, "filter");
}

void VoxelFilter::count(const Cloud& cloud, WorkerPool& pool) {
  evidence_.see(cloud, {}, lattice_, limits_, pool);
  for (std::size_t i = 0; i < evidence_.bricks().size(); ++i) {
    const BrickMarks& seen = evidence_.bricks().value(i);
    BrickCounts& counts = counts_.touch(evidence_.bricks().ids()[i]);
    add_marks(seen.ended, counts.ended);
    add_marks(seen.passed, counts.passed);
  }
}

double VoxelFilter::static_probability(const VoxelKey& key) const {
  const BrickCounts* counts = counts_.find(brick_id(key));
  if (counts == nullptr) return config_.prior;
  const unsigned place = place_in_brick(key);
  if (counts->ended[place] + counts->passed[place] == 0) return config_.prior;
  const double ended = config_.static_clouds + counts->ended[place];
  const double passed = counts->passed[place];
  const double p = config_.prior;
  const double m = std::max(
      0.0, (ended * (2.0 * p - 1.0) - passed * (1.0 - p)) / ((2.0 * p - 1.0) * (ended + passed)));
  return p * m / (p * m + (1.0 - p) * (1.0 - m));
}

std::vector<std::uint8_t> VoxelFilter::label(const Cloud& cloud, WorkerPool& pool) const {
  CloudInMap in_map;
  bring_into_map(cloud, pool, in_map);
  const std::vector<Eigen::Vector3f>& ends = in_map.ends_m;
  std::vector<std::uint8_t> is_dynamic(ends.size(), 0);
  pool.for_chunks(ends.size(), 4096, [&](std::size_t begin, std::size_t end, std::size_t) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto key = lattice_.key_at(ends[i]);
      if (!key || !limits_.box.contains(*key)) continue;
      const auto range = static_cast<double>(cloud.points_m[i].norm());
      if (limits_.max_range_m > 0.0 && range > limits_.max_range_m) continue;
      is_dynamic[i] = static_probability(*key) < 0.5 ? 1 : 0;
    }
  });
  return is_dynamic;
}

}  // namespace strata::volume
