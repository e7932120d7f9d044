// SPDX-License-Identifier: Apache-2.0
#include "core/volume/voxel_filter.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "core/volume/cloud_in_map.hpp"

namespace strata::volume {
namespace {

/// Half the width of the surroundings that tell a voxel's surface [voxels].
constexpr std::int32_t kReach = 2;

void halve(BrickCounts& counts, unsigned place) {
  Passes& passed = counts.passed[place];
  counts.ended[place] /= 2;
  passed.clouds /= 2;
  for (std::int16_t* sum : {&passed.xx, &passed.yy, &passed.xy, &passed.xz, &passed.yz}) *sum /= 2;
}

void make_room(BrickCounts& counts, unsigned place) {
  const bool is_full = counts.ended[place] >= BrickCounts::kFull ||
                       counts.passed[place].clouds >= BrickCounts::kFull;
  if (is_full) halve(counts, place);
}

void add(const Eigen::Vector3d& direction, Passes& passes) {
  const auto part = [&](int i, int j) {
    return static_cast<std::int16_t>(std::lround(Passes::kUnit * direction[i] * direction[j]));
  };
  ++passes.clouds;
  passes.xx += part(0, 0);
  passes.yy += part(1, 1);
  passes.xy += part(0, 1);
  passes.xz += part(0, 2);
  passes.yz += part(1, 2);
}

/// The sum of d d^T.
Eigen::Matrix3d directions_of(const Passes& passes) {
  Eigen::Matrix3d sum;
  sum << passes.xx, passes.xy, passes.xz, passes.xy, passes.yy, passes.yz, passes.xz, passes.yz, 0;
  sum /= Passes::kUnit;
  sum(2, 2) = passes.clouds - sum(0, 0) - sum(1, 1);
  return sum;
}

}  // namespace

VoxelFilter::VoxelFilter(const VoxelFilterConfig& config, const VoxelLattice& lattice,
                         const RayLimits& limits)
    : config_(config), lattice_(lattice), limits_(limits) {
  require_valid(config, "filter");
}

void VoxelFilter::count(const Cloud& cloud, WorkerPool& pool) {
  evidence_.see(cloud, {}, lattice_, limits_, pool);
  const Eigen::Vector3d origin = evidence_.origin_m().cast<double>();
  for (std::size_t i = 0; i < evidence_.bricks().size(); ++i) {
    const BrickMarks& seen = evidence_.bricks().value(i);
    BrickCounts& counts = counts_.touch(evidence_.bricks().ids()[i]);
    for_each_place(seen.ended, [&](unsigned place) {
      make_room(counts, place);
      ++counts.ended[place];
    });
    for_each_place(seen.passed, [&](unsigned place) {
      make_room(counts, place);
      const VoxelKey key = voxel_of(evidence_.bricks().ids()[i], place);
      add((lattice_.center_m(key) - origin).normalized(), counts.passed[place]);
    });
  }
}

const BrickCounts* VoxelFilter::counts_at(const VoxelKey& key) const {
  return VoxelBox{}.contains(key) ? counts_.find(brick_id(key)) : nullptr;
}

double VoxelFilter::passed_across(const VoxelKey& key, const Passes& passes) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  double weights = 0.0;
  for (std::int32_t z = -kReach; z <= kReach; ++z) {
    for (std::int32_t y = -kReach; y <= kReach; ++y) {
      for (std::int32_t x = -kReach; x <= kReach; ++x) {
        const VoxelKey other{key.x + x, key.y + y, key.z + z};
        const BrickCounts* counts = counts_at(other);
        const double weight = counts == nullptr ? 0.0 : counts->ended[place_in_brick(other)];
        if (weight == 0.0) continue;
        const Eigen::Vector3d place(x, y, z);
        weights += weight;
        sum += weight * place;
        squares += weight * place * place.transpose();
      }
    }
  }
  if (weights == 0.0) return passes.clouds;
  const Eigen::Vector3d mean = sum / weights;
  const Eigen::Matrix3d spread = squares / weights - mean * mean.transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes;
  axes.computeDirect(spread, Eigen::EigenvaluesOnly);
  const double thickness = axes.eigenvalues()[0];
  const double width = axes.eigenvalues()[2];
  if (width < 1e-6) return passes.clouds;  // a voxel by itself
  const double along =
      ((spread * directions_of(passes)).trace() - thickness * passes.clouds) / width;
  return std::clamp(passes.clouds - along, 0.0, static_cast<double>(passes.clouds));
}

double VoxelFilter::probability_of(double ended, double passed) const {
  const double h = config_.static_clouds + ended;
  const double p = config_.prior;
  const double m =
      std::max(0.0, (h * (2.0 * p - 1.0) - passed * (1.0 - p)) / ((2.0 * p - 1.0) * (h + passed)));
  return p * m / (p * m + (1.0 - p) * (1.0 - m));
}

double VoxelFilter::static_probability(const VoxelKey& key) const {
  const BrickCounts* counts = counts_at(key);
  if (counts == nullptr) return config_.prior;
  const unsigned place = place_in_brick(key);
  const Passes& passes = counts->passed[place];
  if (counts->ended[place] + passes.clouds == 0) return config_.prior;
  return probability_of(counts->ended[place], passed_across(key, passes));
}

bool VoxelFilter::is_dynamic(const VoxelKey& key) const {
  const BrickCounts* counts = counts_at(key);
  if (counts == nullptr) return false;
  const unsigned place = place_in_brick(key);
  // Weights only speak for static, so that most voxels need no look about them.
  const Passes& passes = counts->passed[place];
  return probability_of(counts->ended[place], passes.clouds) < 0.5 &&
         probability_of(counts->ended[place], passed_across(key, passes)) < 0.5;
}

std::vector<std::uint8_t> VoxelFilter::label(const Cloud& cloud, WorkerPool& pool) const {
  CloudInMap in_map;
  bring_into_map(cloud, pool, in_map);
  const std::vector<Eigen::Vector3f>& ends = in_map.ends_m;
  std::vector<std::uint8_t> moves(ends.size(), 0);
  pool.for_chunks(ends.size(), 4096, [&](std::size_t begin, std::size_t end, std::size_t) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto key = lattice_.key_at(ends[i]);
      if (!key || !limits_.box.contains(*key)) continue;
      const auto range = static_cast<double>(cloud.points_m[i].norm());
      if (limits_.max_range_m > 0.0 && range > limits_.max_range_m) continue;
      moves[i] = is_dynamic(*key) ? 1 : 0;
    }
  });
  return moves;
}

}  // namespace strata::volume
