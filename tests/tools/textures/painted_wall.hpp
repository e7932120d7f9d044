// SPDX-License-Identifier: Apache-2.0
/// A wall of voxels, and cameras that see it.
#pragma once

#include <vector>

#include "core/base/parallel.hpp"
#include "core/volume/color_map.hpp"
#include "core/volume/volume_map.hpp"

namespace strata::textures::test_wall {

/// A wall at x = 3.05, |y| < 1, seen from the origin at 1 m height.
inline volume::VolumeMap map_of_wall() {
  WorkerPool pool(1);
  volume::VolumeMap map(volume::VolumeConfig{});
  volume::Cloud cloud;
  cloud.map_from_sensor.translation = {0.05, 0.05, 1.05};
  for (int y = -9; y <= 9; ++y) {
    for (int z = -5; z <= 5; ++z) {
      cloud.points_m.push_back({3.0F, 0.1F * static_cast<float>(y), 0.1F * static_cast<float>(z)});
    }
  }
  for (int i = 0; i < 3; ++i) map.insert(cloud, {}, pool);
  return map;
}

/// A camera at (x, 0.05, 1.05) that looks along x.
inline volume::CameraView looking(double x, const volume::ColorImage& image) {
  volume::CameraView view;
  view.map_from_camera.translation = {x, 0.05, 1.05};
  Eigen::Matrix3d axes;
  axes << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  view.map_from_camera.rotation = Eigen::Quaterniond(axes);
  view.camera = {200, 200, 200.0, 200.0, 99.5, 99.5, {}};
  view.image = &image;
  return view;
}

inline constexpr volume::Rgb kRed{200, 0, 0};
inline constexpr volume::Rgb kGreen{0, 200, 0};
inline constexpr volume::Rgb kBlue{0, 0, 200};
inline constexpr volume::Rgb kGrey{90, 90, 90};

/// Grey in the upper rows, above 1.15 m on the wall, in the midst of a voxel; below it two halves.
inline volume::ColorImage halves(volume::Rgb left, volume::Rgb right) {
  volume::ColorImage image{200, 200, {}};
  for (int i = 0; i < 200 * 200; ++i) {
    const volume::Rgb half = i % 200 < 100 ? left : right;
    image.pixels.push_back(i / 200 < 93 ? kGrey : half);
  }
  return image;
}

struct Wall {
  volume::VolumeMap map = map_of_wall();
  volume::ColorImage first = halves(kRed, kGreen);
  volume::ColorImage second = halves(kBlue, kBlue);
  volume::ColorMap colors{{}, map, {}};
  Wall() {
    WorkerPool pool(1);
    colors.add(looking(0.05, first), pool);
    // From beyond the wall's range of view: offered, and shows nothing.
    colors.add(looking(40.0, second), pool);
  }
};

}  // namespace strata::textures::test_wall
