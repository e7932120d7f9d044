// SPDX-License-Identifier: Apache-2.0
/// Calibrated cameras and their pictures.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/volume/rgb.hpp"

namespace strata::volume {

/// A pinhole with the distortion of Brown and Conrady, as sensor_msgs/CameraInfo tells it. The
/// camera's frame is optical: x right, y down, z ahead. Pixel (0, 0) has its middle at (0, 0).
struct Camera {
  int width = 0;
  int height = 0;
  double focal_x = 0.0;  ///< pixels
  double focal_y = 0.0;
  double middle_x = 0.0;  ///< principal point, pixels
  double middle_y = 0.0;
  /// k1, k2, p1, p2, k3, k4, k5, k6; 0: none.
  std::array<double, 8> distortion{};
};

/// Where a point of the camera's frame appears [pixels]; nothing behind the camera, outside the
/// picture, and where the distortion folds over. O(1).
[[nodiscard]] std::optional<Eigen::Vector2d> project(const Camera& camera,
                                                     const Eigen::Vector3d& in_camera_m);

/// Rows from the top, x fastest.
struct ColorImage {
  int width = 0;
  int height = 0;
  std::vector<Rgb> pixels;

  [[nodiscard]] const Rgb& at(int x, int y) const {
    return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(x)];
  }
};

}  // namespace strata::volume
