// SPDX-License-Identifier: Apache-2.0
#include "tools/textures/planes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <Eigen/Eigenvalues>

namespace strata::textures {
namespace {

using volume::ColoredVoxel;
using volume::VoxelKey;

constexpr std::int32_t kAround = 2;
constexpr double kUpright = 0.2;  // least length of the level part of an upright plane's normal
/// A surface around a voxel: more neighbours than an edge has, and thin.
constexpr std::size_t kFewest = 8;

/// Sums of points, for their plane.
class Fit {
 public:
  void add(const Eigen::Vector3d& point) {
    sum_ += point;
    squares_ += point * point.transpose();
    count_ += 1.0;
  }
  [[nodiscard]] Eigen::Vector3d mean() const { return sum_ / count_; }
  /// Normal, and the variances across and along the narrow side.
  struct Axes {
    Eigen::Vector3d normal;
    double across;
    double along;
  };
  [[nodiscard]] Axes axes() const {
    const Eigen::Matrix3d spread = squares_ / count_ - mean() * mean().transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
    return {solver.eigenvectors().col(0), solver.eigenvalues()(0), solver.eigenvalues()(1)};
  }
  [[nodiscard]] double count() const { return count_; }

 private:
  Eigen::Vector3d sum_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares_ = Eigen::Matrix3d::Zero();
  double count_ = 0.0;
};

template <typename Visit>
void for_each_around(const VoxelKey& key, std::int32_t reach, Visit&& visit) {
  for (std::int32_t z = -reach; z <= reach; ++z) {
    for (std::int32_t y = -reach; y <= reach; ++y) {
      for (std::int32_t x = -reach; x <= reach; ++x) {
        if (x != 0 || y != 0 || z != 0) visit(VoxelKey{key.x + x, key.y + y, key.z + z});
      }
    }
  }
}

/// In units of voxels about the first, so that squares stay small.
class Grower {
 public:
  Grower(std::span<const ColoredVoxel> voxels, const PlaneConfig& config)
      : voxels_(voxels), config_(config), index_(index_of(voxels)), is_taken_(voxels.size(), 0) {
    for (std::size_t i = 0; i < voxels.size(); ++i) measure(i);
  }

  std::vector<std::vector<std::size_t>> grow() {
    std::vector<std::size_t> order(voxels_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return flatness_[a] > flatness_[b]; });
    std::vector<std::vector<std::size_t>> regions;
    for (const std::size_t seed : order) {
      if (is_taken_[seed] != 0 || flatness_[seed] <= 0.0) continue;
      std::vector<std::size_t> region = grow_from(seed);
      if (region.size() < static_cast<std::size_t>(config_.min_voxels)) {
        for (const std::size_t i : region) is_taken_[i] = 0;
        is_taken_[seed] = 1;  // in no other region either
        continue;
      }
      regions.push_back(std::move(region));
    }
    return regions;
  }

  [[nodiscard]] Eigen::Vector3d at(std::size_t i) const {
    const VoxelKey& key = voxels_[i].key;
    const VoxelKey& first = voxels_[0].key;
    return {static_cast<double>(key.x - first.x), static_cast<double>(key.y - first.y),
            static_cast<double>(key.z - first.z)};
  }

  /// The region with the voxels beside it that lie in its plane, whosever they are: at an edge the
  /// surroundings of as many rows as were looked at are bent.
  [[nodiscard]] std::vector<std::size_t> with_rim(std::vector<std::size_t> region,
                                                  const Fit& fit) const {
    const Eigen::Vector3d normal = fit.axes().normal;
    for (std::int32_t row = 0; row < kAround; ++row) {
      const std::vector<std::size_t> inner = region;
      for (const std::size_t i : inner) {
        for_each_around(voxels_[i].key, 1, [&](const VoxelKey& key) {
          const auto found = index_.find(key);
          if (found == index_.end()) return;
          const double off = std::abs(normal.dot(at(found->second) - fit.mean()));
          if (off <= config_.max_off_voxels) region.push_back(found->second);
        });
      }
      std::sort(region.begin(), region.end());
      region.erase(std::unique(region.begin(), region.end()), region.end());
    }
    return region;
  }

 private:
  void measure(std::size_t i) {
    Fit fit;
    fit.add(at(i));
    for_each_around(voxels_[i].key, kAround, [&](const VoxelKey& key) {
      const auto found = index_.find(key);
      if (found != index_.end()) fit.add(at(found->second));
    });
    const Fit::Axes axes = fit.axes();
    normals_.push_back(axes.normal);
    const bool is_flat = fit.count() > kFewest && axes.along > 4.0 * axes.across;
    flatness_.push_back(is_flat ? fit.count() / (0.1 + axes.across) : 0.0);
  }

  std::vector<std::size_t> grow_from(std::size_t seed) {
    Fit fit;
    fit.add(at(seed));
    Eigen::Vector3d normal = normals_[seed];
    double refit_at = 24.0;
    std::vector<std::size_t> region{seed};
    is_taken_[seed] = 1;
    for (std::size_t next = 0; next < region.size(); ++next) {
      const VoxelKey key = voxels_[region[next]].key;
      for_each_around(key, 1, [&](const VoxelKey& other) {
        const auto found = index_.find(other);
        if (found == index_.end() || is_taken_[found->second] != 0) return;
        const std::size_t i = found->second;
        if (std::abs(normal.dot(at(i) - fit.mean())) > config_.max_off_voxels) return;
        if (std::abs(normal.dot(normals_[i])) < std::cos(config_.max_angle_rad)) return;
        is_taken_[i] = 1;
        fit.add(at(i));
        region.push_back(i);
      });
      if (fit.count() < refit_at) continue;
      normal = fit.axes().normal;
      refit_at = 2.0 * fit.count();
    }
    return region;
  }

  std::span<const ColoredVoxel> voxels_;
  PlaneConfig config_;
  VoxelIndex index_;
  std::vector<std::uint8_t> is_taken_;
  std::vector<Eigen::Vector3d> normals_;
  std::vector<double> flatness_;  ///< 0: neither flat nor a beginning
};

/// u level where the plane is upright, else x as it lies in the plane.
void set_axes(Plane& plane) {
  const Eigen::Vector3d level = Eigen::Vector3d::UnitZ().cross(plane.normal);
  const Eigen::Vector3d along =
      level.norm() > kUpright
          ? level
          : Eigen::Vector3d(Eigen::Vector3d::UnitX() - plane.normal.x() * plane.normal);
  plane.u = along.normalized();
  plane.v = plane.normal.cross(plane.u);
}

}  // namespace

VoxelIndex index_of(std::span<const ColoredVoxel> voxels) {
  VoxelIndex index;
  index.reserve(voxels.size());
  for (std::size_t i = 0; i < voxels.size(); ++i) index.emplace(voxels[i].key, i);
  return index;
}

std::vector<Plane> find_planes(std::span<const ColoredVoxel> voxels,
                               const volume::VoxelLattice& lattice, const PlaneConfig& config) {
  require_valid(config, "planes");
  std::vector<Plane> planes;
  if (voxels.empty()) return planes;
  Grower grower(voxels, config);
  const Eigen::Vector3d first_m = lattice.center_m(voxels[0].key);
  for (const std::vector<std::size_t>& region : grower.grow()) {
    Fit fit;
    for (const std::size_t i : region) fit.add(grower.at(i));
    Plane plane;
    plane.origin_m = first_m + lattice.resolution_m() * fit.mean();
    plane.normal = fit.axes().normal;
    set_axes(plane);
    plane.voxels = grower.with_rim(region, fit);
    planes.push_back(std::move(plane));
  }
  std::stable_sort(planes.begin(), planes.end(), [](const Plane& a, const Plane& b) {
    return a.voxels.size() > b.voxels.size();
  });
  return planes;
}

}  // namespace strata::textures
