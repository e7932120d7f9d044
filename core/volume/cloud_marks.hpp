// SPDX-License-Identifier: Apache-2.0
/// What one cloud says of space: voxels that rays passed, and voxels in which they ended.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/base/parallel.hpp"
#include "core/volume/brick_map.hpp"
#include "core/volume/voxel.hpp"

namespace strata::volume {

/// A bit a voxel, in the order of `place_in_brick`.
struct BrickMarks {
  std::array<std::uint64_t, 8> passed{};
  std::array<std::uint64_t, 8> ended{};
};

/// What became of a cloud's points.
struct CloudCounts {
  std::size_t points = 0;
  std::size_t not_finite = 0;     ///< NaN or infinite; skipped
  std::size_t beyond_range = 0;   ///< only the space up to the range was freed
  std::size_t outside = 0;        ///< end point outside the lattice or the box
  std::size_t dynamic = 0;        ///< end point not entered
  std::size_t voxels_passed = 0;  ///< distinct, without those ended in
  std::size_t voxels_ended = 0;   ///< distinct

  CloudCounts& operator+=(const CloudCounts& other);
};

/// How rays are cut.
struct RayLimits {
  double max_range_m = 0.0;  ///< 0: no limit
  VoxelBox box;
};

/// Where the rays of points come from.
struct RayOrigin {
  std::size_t begin = 0;  ///< its first point; it holds up to the next origin
  Eigen::Vector3f origin_m = Eigen::Vector3f::Zero();
};

/// Marks of whole clouds; reused from cloud to cloud, so that memory is taken once.
class CloudMarks {
 public:
  /// Replaces the marks by those of one cloud. origins: in order, the first begins at 0. Origins
  /// and ends_m: in the map frame. is_dynamic: empty, or a
  /// flag a point: the ray frees what it passed, its end says nothing. A voxel in which a point
  /// ended counts as ended in only. Rays are walked as OctoMap's computeUpdate walks them
  /// [hornung2013octomap], except that a box here cuts them instead of dropping those that end
  /// outside. The same marks for any number of threads. O(voxels that rays pass).
  CloudCounts mark(std::span<const RayOrigin> origins, std::span<const Eigen::Vector3f> ends_m,
                   std::span<const std::uint8_t> is_dynamic, const VoxelLattice& lattice,
                   const RayLimits& limits, WorkerPool& pool);

  [[nodiscard]] const BrickMap<BrickMarks>& bricks() const { return lanes_.front(); }

 private:
  void merge_lanes(CloudCounts& counts);
  std::vector<BrickMap<BrickMarks>> lanes_;
};

}  // namespace strata::volume
