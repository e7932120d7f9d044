// SPDX-License-Identifier: Apache-2.0
#include "core/volume/voxel_memory.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

namespace strata::volume {
namespace {

constexpr double kWhole = 65535.0;

}  // namespace

VoxelMemory::VoxelMemory(const VoxelMemoryConfig& config, const VoxelLattice& lattice,
                         const RayLimits& limits)
    : config_(config), lattice_(lattice), limits_(limits) {
  require_valid(config, "memory");
  const std::array<double, kVoxelLevels> half_lives{config.short_clouds, config.mid_clouds,
                                                    config.long_clouds};
  for (std::size_t level = 0; level < kVoxelLevels; ++level) {
    rates_[level] = -std::expm1(-std::numbers::ln2 / half_lives[level]);
  }
}

void VoxelMemory::learn(Brick& brick, const BrickBits& voxels, bool is_end) const {
  for_each_place(voxels, [&](unsigned place) {
    std::uint8_t& seen = brick.seen[place];
    if (seen < 255) ++seen;
    for (std::size_t level = 0; level < kVoxelLevels; ++level) {
      const double rate = std::max(rates_[level], 1.0 / seen);
      std::uint16_t& share = brick.share[level][place];
      const double value = share + rate * ((is_end ? kWhole : 0.0) - share);
      share = static_cast<std::uint16_t>(std::lround(value));
    }
  });
}

void VoxelMemory::observe(const Cloud& cloud, std::span<const std::uint8_t> is_dynamic,
                          WorkerPool& pool) {
  evidence_.see(cloud, is_dynamic, lattice_, limits_, pool);
  for (std::size_t i = 0; i < evidence_.bricks().size(); ++i) {
    Brick& brick = bricks_.touch(evidence_.bricks().ids()[i]);
    learn(brick, evidence_.bricks().value(i).ended, true);
    learn(brick, evidence_.bricks().value(i).passed, false);
  }
}

std::optional<double> VoxelMemory::occupancy(const VoxelKey& key, VoxelLevel level) const {
  const Brick* brick = bricks_.find(brick_id(key));
  const unsigned place = place_in_brick(key);
  if (brick == nullptr || brick->seen[place] == 0) return std::nullopt;
  return brick->share[static_cast<std::size_t>(level)][place] / kWhole;
}

void VoxelMemory::for_each_voxel(VoxelLevel level,
                                 const std::function<void(const VoxelKey&, double)>& visit) const {
  for (std::size_t i = 0; i < bricks_.size(); ++i) {
    const Brick& brick = bricks_.value(i);
    const auto& share = brick.share[static_cast<std::size_t>(level)];
    for (unsigned place = 0; place < kBrickVoxels; ++place) {
      if (brick.seen[place] == 0) continue;
      visit(voxel_of(bricks_.ids()[i], place), share[place] / kWhole);
    }
  }
}

std::size_t VoxelMemory::known_voxels() const {
  std::size_t known = 0;
  for (std::size_t i = 0; i < bricks_.size(); ++i) {
    const auto& seen = bricks_.value(i).seen;
    known += kBrickVoxels - static_cast<std::size_t>(std::count(seen.begin(), seen.end(), 0));
  }
  return known;
}

std::vector<VolumeChange> VoxelMemory::changes() const {
  std::array<std::set<VoxelKey>, 2> changed;  // gone, appeared
  for (std::size_t i = 0; i < bricks_.size(); ++i) {
    const Brick& brick = bricks_.value(i);
    for (unsigned place = 0; place < kBrickVoxels; ++place) {
      if (brick.seen[place] == 0) continue;
      const double difference = (brick.share.front()[place] - brick.share.back()[place]) / kWhole;
      if (std::abs(difference) < config_.min_change) continue;
      changed[difference > 0.0 ? 1 : 0].insert(voxel_of(bricks_.ids()[i], place));
    }
  }
  std::vector<VolumeChange> changes;
  for (const bool appeared : {false, true}) {
    std::set<VoxelKey>& left = changed[appeared ? 1 : 0];
    while (!left.empty()) {
      VolumeChange change{appeared, {}, *left.begin(), *left.begin()};
      std::vector<VoxelKey> open{*left.begin()};
      left.erase(left.begin());
      while (!open.empty()) {
        const VoxelKey key = open.back();
        open.pop_back();
        change.voxels.push_back(key);
        change.min = {std::min(change.min.x, key.x), std::min(change.min.y, key.y),
                      std::min(change.min.z, key.z)};
        change.max = {std::max(change.max.x, key.x), std::max(change.max.y, key.y),
                      std::max(change.max.z, key.z)};
        for (std::int32_t n = 0; n < 27; ++n) {
          const auto found =
              left.find({key.x + n % 3 - 1, key.y + n / 3 % 3 - 1, key.z + n / 9 - 1});
          if (found == left.end()) continue;
          open.push_back(*found);
          left.erase(found);
        }
      }
      if (change.voxels.size() >= static_cast<std::size_t>(config_.min_voxels)) {
        std::sort(change.voxels.begin(), change.voxels.end());
        changes.push_back(std::move(change));
      }
    }
  }
  std::stable_sort(changes.begin(), changes.end(),
                   [](const auto& a, const auto& b) { return a.voxels.size() > b.voxels.size(); });
  return changes;
}

}  // namespace strata::volume
