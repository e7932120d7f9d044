// SPDX-License-Identifier: Apache-2.0
#include "core/volume/voxel_filter.hpp"

#include <algorithm>
#include <bit>
#include <limits>

#include "core/volume/volume_map.hpp"

namespace strata::volume {
namespace {

void add_marks(std::uint64_t marks, std::size_t first,
               std::array<std::uint16_t, kBrickVoxels>& to) {
  for (; marks != 0; marks &= marks - 1) {
    std::uint16_t& count = to[first + static_cast<std::size_t>(std::countr_zero(marks))];
    if (count < std::numeric_limits<std::uint16_t>::max()) ++count;
  }
}

}  // namespace

VoxelFilter::VoxelFilter(const VoxelFilterConfig& config, const VoxelLattice& lattice,
                         const RayLimits& limits)
    : config_(config), lattice_(lattice), limits_(limits) {
  require_valid(config, "filter");
}

void VoxelFilter::count(const Cloud& cloud, WorkerPool& pool) {
  CloudInMap in_map;
  bring_into_map(cloud, pool, in_map);
  marks_.mark(in_map.origins, in_map.ends_m, {}, lattice_, limits_, pool);
  near_ends_.find(marks_.bricks());
  for (std::size_t i = 0; i < marks_.bricks().size(); ++i) {
    BrickMarks marks = marks_.bricks().value(i);
    marks.passed = near_ends_.without(marks_.bricks().ids()[i], marks.passed);
    BrickCounts& counts = counts_.touch(marks_.bricks().ids()[i]);
    for (std::size_t word = 0; word < 8; ++word) {
      add_marks(marks.ended[word], 64 * word, counts.ended);
      add_marks(marks.passed[word], 64 * word, counts.passed);
    }
  }
}

double VoxelFilter::static_probability(const VoxelKey& key) const {
  const BrickCounts* counts = counts_.find(brick_id(key));
  if (counts == nullptr) return config_.prior;
  const unsigned place = place_in_brick(key);
  const double ended = counts->ended[place];
  const double passed = counts->passed[place];
  if (ended + passed == 0.0) return config_.prior;
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
