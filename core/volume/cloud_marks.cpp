// SPDX-License-Identifier: Apache-2.0
#include "core/volume/cloud_marks.hpp"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>

#include "core/volume/voxel_ray.hpp"

namespace strata::volume {
namespace {

constexpr std::size_t kPointsAtATime = 512;

/// Marks the rays that one thread walks.
class Lane {
 public:
  Lane(BrickMap<BrickMarks>& bricks, const VoxelLattice& lattice, const RayLimits& limits)
      : bricks_(bricks),
        lattice_(lattice),
        limits_(limits),
        is_boxed_(!limits.box.is_everything()) {}

  void start_from(const Eigen::Vector3f& origin) {
    origin_ = origin;
    origin_key_ = lattice_.key_at(origin);
  }

  void add(const Eigen::Vector3f& end, bool is_dynamic, CloudCounts& counts) {
    ++counts.points;
    if (!end.allFinite()) {
      ++counts.not_finite;
      return;
    }
    const Eigen::Vector3f ray = end - origin_;
    // Float sum, double root: as OctoMap measures.
    const float squared = ray.x() * ray.x() + ray.y() * ray.y() + ray.z() * ray.z();
    const double range = std::sqrt(static_cast<double>(squared));
    if (limits_.max_range_m > 0.0 && range > limits_.max_range_m) {
      ++counts.beyond_range;
      const Eigen::Vector3f direction = ray / static_cast<float>(range);
      pass(origin_ + direction * static_cast<float>(limits_.max_range_m));
      return;
    }
    const auto end_key = pass(end);
    if (is_dynamic) ++counts.dynamic;
    if (!end_key || !limits_.box.contains(*end_key)) {
      ++counts.outside;
    } else if (!is_dynamic) {
      const unsigned place = place_in_brick(*end_key);
      bricks_.touch(brick_id(*end_key)).ended[place >> 6] |= std::uint64_t{1} << (place & 63U);
    }
  }

 private:
  std::optional<VoxelKey> pass(const Eigen::Vector3f& end) {
    const auto end_key = lattice_.key_at(end);
    if (!origin_key_ || !end_key) return end_key;
    if (is_boxed_) {
      walk<true>(*end_key, end);
    } else {
      walk<false>(*end_key, end);
    }
    return end_key;
  }

  template <bool kBoxed>
  void walk(const VoxelKey& end_key, const Eigen::Vector3f& end) {
    std::uint64_t current = ~std::uint64_t{0};
    BrickMarks* marks = nullptr;
    trace_ray(lattice_, *origin_key_, end_key, origin_, end, [&](const VoxelKey& key) {
      if (kBoxed && !limits_.box.contains(key)) return;
      const std::uint64_t id = brick_id(key);
      if (id != current) {
        marks = &bricks_.touch(id);
        current = id;
      }
      const unsigned place = place_in_brick(key);
      marks->passed[place >> 6] |= std::uint64_t{1} << (place & 63U);
    });
  }

  BrickMap<BrickMarks>& bricks_;
  const VoxelLattice& lattice_;
  const RayLimits& limits_;
  Eigen::Vector3f origin_ = Eigen::Vector3f::Zero();
  std::optional<VoxelKey> origin_key_;
  bool is_boxed_;
};

}  // namespace

CloudCounts& CloudCounts::operator+=(const CloudCounts& other) {
  points += other.points;
  not_finite += other.not_finite;
  beyond_range += other.beyond_range;
  outside += other.outside;
  dynamic += other.dynamic;
  voxels_passed += other.voxels_passed;
  voxels_ended += other.voxels_ended;
  return *this;
}

CloudCounts CloudMarks::mark(std::span<const RayOrigin> origins,
                             std::span<const Eigen::Vector3f> ends_m,
                             std::span<const std::uint8_t> is_dynamic, const VoxelLattice& lattice,
                             const RayLimits& limits, WorkerPool& pool) {
  const auto lanes = static_cast<std::size_t>(pool.threads());
  lanes_.resize(std::max(lanes, lanes_.size()));
  for (auto& lane : lanes_) lane.clear();
  std::vector<CloudCounts> counts(lanes);
  // Threads take points as they come: marks are united and counts added, so the order cannot
  // matter.
  std::atomic<std::size_t> next{0};
  pool.for_chunks(lanes, 1, [&](std::size_t number, std::size_t, std::size_t) {
    Lane lane(lanes_[number], lattice, limits);
    CloudCounts sum;
    while (true) {
      const std::size_t begin = next.fetch_add(kPointsAtATime);
      if (begin >= ends_m.size()) break;
      const std::size_t end = std::min(ends_m.size(), begin + kPointsAtATime);
      auto origin = std::upper_bound(origins.begin(), origins.end(), begin,
                                     [](std::size_t i, const RayOrigin& o) { return i < o.begin; });
      lane.start_from((origin - 1)->origin_m);
      for (std::size_t i = begin; i < end; ++i) {
        for (; origin != origins.end() && origin->begin == i; ++origin) {
          lane.start_from(origin->origin_m);
        }
        lane.add(ends_m[i], !is_dynamic.empty() && is_dynamic[i] != 0, sum);
      }
    }
    counts[number] = sum;
  });
  CloudCounts total;
  for (const CloudCounts& part : counts) total += part;
  merge_lanes(total);
  return total;
}

void CloudMarks::merge_lanes(CloudCounts& counts) {
  BrickMap<BrickMarks>& first = lanes_.front();
  for (std::size_t lane = 1; lane < lanes_.size(); ++lane) {
    for (std::size_t i = 0; i < lanes_[lane].size(); ++i) {
      const BrickMarks& from = lanes_[lane].value(i);
      BrickMarks& to = first.touch(lanes_[lane].ids()[i]);
      for (std::size_t word = 0; word < 8; ++word) {
        to.passed[word] |= from.passed[word];
        to.ended[word] |= from.ended[word];
      }
    }
  }
  for (std::size_t i = 0; i < first.size(); ++i) {
    BrickMarks& marks = first.value(i);
    for (std::size_t word = 0; word < 8; ++word) {
      marks.passed[word] &= ~marks.ended[word];
      counts.voxels_passed += static_cast<std::size_t>(std::popcount(marks.passed[word]));
      counts.voxels_ended += static_cast<std::size_t>(std::popcount(marks.ended[word]));
    }
  }
}

}  // namespace strata::volume
