// SPDX-License-Identifier: Apache-2.0
#include "core/volume/color_map.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "core/scan/endpoints.hpp"
#include "core/volume/voxel_ray.hpp"

namespace strata::volume {
namespace {

constexpr double kSurelyStatic = 0.95;
/// A label of exactly 0 must not forbid a view that is the only one.
constexpr double kMinStatic = 1e-3;

}  // namespace

std::vector<MovingWitness> moving_witnesses(std::span<const PosedScan> scans) {
  std::vector<MovingWitness> witnesses;
  for (const PosedScan& scan : scans) {
    const Endpoints ends = endpoints_in_robot(scan.scan);
    for (std::size_t i = 0; i < ends.size(); ++i) {
      if (ends.beam[i] >= scan.static_probability.size()) continue;
      const auto e = static_cast<double>(scan.static_probability[ends.beam[i]]);
      if (e >= kSurelyStatic) continue;
      const Eigen::Vector2d in_robot(ends.x_m[i], ends.y_m[i]);
      witnesses.push_back(
          {scan.scan.stamp, scan.map_from_robot * in_robot, std::log(std::max(e, kMinStatic))});
    }
  }
  std::stable_sort(witnesses.begin(), witnesses.end(),
                   [](const auto& a, const auto& b) { return a.stamp < b.stamp; });
  return witnesses;
}

ColorMap::ColorMap(const ColorConfig& config, const VolumeMap& map,
                   std::vector<MovingWitness> witnesses)
    : config_(config), lattice_(map.lattice()), witnesses_(std::move(witnesses)) {
  require_valid(config, "colors");
  map.for_each_cube([&](const VoxelCube& cube) {
    if (!cube.is_occupied) return;
    for_each_voxel(cube, [&](const VoxelKey& key) {
      ColoredVoxel voxel;
      voxel.key = key;
      voxel.log_odds = cube.log_odds;
      voxels_.push_back(voxel);
      const unsigned place = place_in_brick(key);
      occupied_.touch(brick_id(key))[place >> 6] |= std::uint64_t{1} << (place & 63U);
    });
  });
  normals_.reserve(voxels_.size());
  for (const ColoredVoxel& voxel : voxels_) normals_.push_back(normal_of(map, voxel.key));
}

bool ColorMap::is_occupied(const VoxelKey& key) const {
  if (!VoxelBox{}.contains(key)) return false;
  const Bits* bits = occupied_.find(brick_id(key));
  const unsigned place = place_in_brick(key);
  return bits != nullptr && ((*bits)[place >> 6] >> (place & 63U) & 1U) != 0;
}

Eigen::Vector3f ColorMap::normal_of(const VolumeMap& map, const VoxelKey& key) const {
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (std::int32_t z = -1; z <= 1; ++z) {
    for (std::int32_t y = -1; y <= 1; ++y) {
      for (std::int32_t x = -1; x <= 1; ++x) {
        const VoxelKey other{key.x + x, key.y + y, key.z + z};
        if ((x == 0 && y == 0 && z == 0) || !VoxelBox{}.contains(other)) continue;
        // Towards what is known to be free: unknown space lies behind walls.
        const auto log_odds = map.log_odds(lattice_.center_m(other));
        if (!log_odds || map.is_occupied(*log_odds)) continue;
        sum += Eigen::Vector3f(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z))
                   .normalized();
      }
    }
  }
  return sum.norm() > 1e-3F ? Eigen::Vector3f(sum.normalized()) : Eigen::Vector3f::Zero();
}

bool ColorMap::is_visible(const Eigen::Vector3f& from_m, const VoxelKey& key) const {
  const auto from_key = lattice_.key_at(from_m);
  if (!from_key) return false;
  const Eigen::Vector3f to_m = lattice_.center_m(key).cast<float>();
  bool is_free = true;
  trace_ray(lattice_, *from_key, key, from_m, to_m, [&](const VoxelKey& passed) {
    // A line that grazes a wall passes the voxels beside its end.
    const bool is_beside = std::abs(passed.x - key.x) <= 1 && std::abs(passed.y - key.y) <= 1 &&
                           std::abs(passed.z - key.z) <= 1;
    if (!is_beside && is_free && is_occupied(passed)) is_free = false;
  });
  return is_free;
}

double ColorMap::log_likelihood(const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m,
                                std::span<const MovingWitness> witnesses) const {
  const Eigen::Vector2d from = from_m.head<2>();
  const Eigen::Vector2d along = to_m.head<2>() - from;
  const double length2 = std::max(along.squaredNorm(), 1e-12);
  double sum = 0.0;
  for (const MovingWitness& witness : witnesses) {
    const double share = std::clamp((witness.place_m - from).dot(along) / length2, 0.0, 1.0);
    const double distance2 = (witness.place_m - from - share * along).squaredNorm();
    if (distance2 > config_.margin_m * config_.margin_m) continue;
    const double height = from_m.z() + share * (to_m.z() - from_m.z());
    if (height <= config_.highest_m) sum += witness.log_static;
  }
  return sum;
}

bool ColorMap::offer(const CameraView& view, const Pose3& camera_from_map,
                     std::span<const MovingWitness> witnesses, std::size_t voxel) {
  ColoredVoxel& to = voxels_[voxel];
  const Eigen::Vector3d center = lattice_.center_m(to.key);
  const Eigen::Vector3d& from = view.map_from_camera.translation;
  const double range = (center - from).norm();
  if (range > config_.max_range_m || range < 1e-6) return false;
  const auto pixel = project(view.camera, camera_from_map * center);
  if (!pixel || !is_visible(from.cast<float>(), to.key)) return false;
  const double log_static = log_likelihood(from, center, witnesses);
  if (log_static < std::log(config_.min_static)) return true;
  const auto likelihood =
      static_cast<std::int32_t>(std::ceil(std::max(log_static / config_.tie_nats, -1e9)));
  const auto frontality =
      static_cast<float>(normals_[voxel].cast<double>().dot(from - center) / range);
  if (std::pair(likelihood, frontality) <= std::pair(to.likelihood, to.frontality) &&
      to.is_seen()) {
    return true;
  }
  to.likelihood = likelihood;
  to.frontality = frontality;
  to.view = offered_;
  const auto nearest = [](double at, int size) {
    return std::clamp(static_cast<int>(std::lround(at)), 0, size - 1);
  };
  to.color = view.image->at(nearest(pixel->x(), view.image->width),
                            nearest(pixel->y(), view.image->height));
  return true;
}

std::size_t ColorMap::add(const CameraView& view, WorkerPool& pool) {
  const Duration window = Duration::from_seconds(config_.window_s);
  const auto begin = std::lower_bound(
      witnesses_.begin(), witnesses_.end(), view.stamp - window,
      [](const MovingWitness& witness, Stamp stamp) { return witness.stamp < stamp; });
  const auto end = std::upper_bound(
      begin, witnesses_.end(), view.stamp + window,
      [](Stamp stamp, const MovingWitness& witness) { return stamp < witness.stamp; });
  const std::span<const MovingWitness> witnesses(begin, end);
  const Pose3 camera_from_map = inverse(view.map_from_camera);
  std::atomic<std::size_t> shown{0};
  pool.for_chunks(voxels_.size(), 512, [&](std::size_t first, std::size_t last, std::size_t) {
    std::size_t mine = 0;
    for (std::size_t i = first; i < last; ++i) {
      mine += offer(view, camera_from_map, witnesses, i) ? 1 : 0;
    }
    shown += mine;
  });
  ++offered_;
  return shown;
}

void ColorMap::color_by_height() {
  if (voxels_.empty()) return;
  std::int32_t lowest = voxels_.front().key.z;
  std::int32_t highest = lowest;
  for (const ColoredVoxel& voxel : voxels_) {
    lowest = std::min(lowest, voxel.key.z);
    highest = std::max(highest, voxel.key.z);
  }
  for (ColoredVoxel& voxel : voxels_) {
    voxel.color =
        height_rgb(static_cast<double>(voxel.key.z - lowest) / std::max(1, highest - lowest));
  }
}

Rgb height_rgb(double share) {
  // Anchors of a rainbow without its dark ends.
  constexpr std::array<std::array<double, 3>, 5> kAnchors{
      {{52, 84, 190}, {42, 157, 198}, {88, 186, 104}, {240, 196, 62}, {214, 72, 58}}};
  const double place = std::clamp(share, 0.0, 1.0) * 4.0;
  const auto below = static_cast<std::size_t>(std::min(3.0, std::floor(place)));
  const double t = place - static_cast<double>(below);
  std::array<std::uint8_t, 3> rgb{};
  for (std::size_t i = 0; i < 3; ++i) {
    rgb[i] = static_cast<std::uint8_t>((1.0 - t) * kAnchors[below][i] + t * kAnchors[below + 1][i]);
  }
  return {rgb[0], rgb[1], rgb[2]};
}

}  // namespace strata::volume
