// SPDX-License-Identifier: Apache-2.0
#include "core/volume/point_colors.hpp"

#include <algorithm>
#include <cmath>

#include "core/volume/color_tree.hpp"

namespace strata::volume {
namespace {

constexpr double kUnit = 256.0;

}  // namespace

PointColors::PointColors(const VolumeConfig& config)
    : lattice_(config.resolution_m), limits_(ray_limits(config)) {}

void PointColors::add(const Cloud& cloud, std::span<const std::uint8_t> is_dynamic,
                      WorkerPool& pool) {
  if (cloud.colors.empty() || cloud.colors.size() != cloud.points_m.size()) return;
  bring_into_map(cloud, pool, in_map_);
  sums_.clear();
  for (std::size_t i = 0; i < in_map_.ends_m.size(); ++i) {
    if (!is_dynamic.empty() && is_dynamic[i] != 0) continue;
    const auto range = static_cast<double>(cloud.points_m[i].norm());
    if (limits_.max_range_m > 0.0 && range > limits_.max_range_m) continue;
    const auto key = lattice_.key_at(in_map_.ends_m[i]);
    if (!key || !limits_.box.contains(*key)) continue;
    Sums& sums = sums_.touch(brick_id(*key));
    const unsigned place = place_in_brick(*key);
    const Rgb& color = cloud.colors[i];
    sums.sum[place][0] += color.r;
    sums.sum[place][1] += color.g;
    sums.sum[place][2] += color.b;
    ++sums.points[place];
  }
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    const Sums& sums = sums_.value(i);
    for (unsigned place = 0; place < kBrickVoxels; ++place) {
      const auto points = static_cast<double>(sums.points[place]);
      if (sums.points[place] == 0) continue;
      const auto& sum = sums.sum[place];
      learn(voxel_of(sums_.ids()[i], place), {sum[0] / points, sum[1] / points, sum[2] / points});
    }
  }
}

void PointColors::learn(const VoxelKey& key, const std::array<double, 3>& rgb) {
  Brick& brick = bricks_.touch(brick_id(key));
  const unsigned place = place_in_brick(key);
  brick.clouds[place] = std::min<std::uint8_t>(kRemembered, brick.clouds[place] + 1);
  for (std::size_t i = 0; i < 3; ++i) {
    std::uint16_t& mean = brick.mean[place][i];
    const double value = mean + (kUnit * rgb[i] - mean) / brick.clouds[place];
    mean = static_cast<std::uint16_t>(std::lround(value));
  }
}

std::optional<Rgb> PointColors::color(const VoxelKey& key) const {
  const Brick* brick = bricks_.find(brick_id(key));
  const unsigned place = place_in_brick(key);
  if (brick == nullptr || brick->clouds[place] == 0) return std::nullopt;
  const auto whole = [](std::uint16_t mean) {
    return static_cast<std::uint8_t>(std::lround(mean / kUnit));
  };
  const auto& mean = brick->mean[place];
  return Rgb{whole(mean[0]), whole(mean[1]), whole(mean[2])};
}

Rgb PointColors::color_or_grey(const VoxelKey& key) const { return color(key).value_or(kGrey); }

std::string PointColors::file(const VolumeMap& map) const {
  return color_file(map, [this](const VoxelKey& key) { return color_or_grey(key); });
}

std::string PointColors::message_data(const VolumeMap& map) const {
  return color_message_data(map, [this](const VoxelKey& key) { return color_or_grey(key); });
}

void PointColors::restore(const std::string& bytes, const std::string& place) {
  read_color_file(bytes, place, lattice_.resolution_m(), [&](const VoxelKey& key, const Rgb& rgb) {
    if (rgb == kGrey) return;
    learn(key,
          {static_cast<double>(rgb.r), static_cast<double>(rgb.g), static_cast<double>(rgb.b)});
  });
}

}  // namespace strata::volume
