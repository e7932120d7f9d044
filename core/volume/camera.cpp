// SPDX-License-Identifier: Apache-2.0
#include "core/volume/camera.hpp"

namespace strata::volume {
namespace {

constexpr double kNearest_m = 0.05;

}  // namespace

std::optional<Eigen::Vector2d> project(const Camera& camera, const Eigen::Vector3d& in_camera_m) {
  if (!(in_camera_m.z() > kNearest_m)) return std::nullopt;
  const double x = in_camera_m.x() / in_camera_m.z();
  const double y = in_camera_m.y() / in_camera_m.z();
  const auto& [k1, k2, p1, p2, k3, k4, k5, k6] = camera.distortion;
  const double r2 = x * x + y * y;
  const double above = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const double below = 1.0 + r2 * (k4 + r2 * (k5 + r2 * k6));
  // Where the distorted radius no longer grows with the true one, points from far outside the
  // picture would come back into it.
  const double growth = (1.0 + r2 * (3.0 * k1 + r2 * (5.0 * k2 + r2 * 7.0 * k3))) * below -
                        2.0 * r2 * above * (k4 + r2 * (2.0 * k5 + r2 * 3.0 * k6));
  if (!(growth > 0.0) || !(below > 0.0)) return std::nullopt;
  const double radial = above / below;
  const double distorted_x = x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x);
  const double distorted_y = y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y;
  const Eigen::Vector2d pixel(camera.focal_x * distorted_x + camera.middle_x,
                              camera.focal_y * distorted_y + camera.middle_y);
  const bool is_inside = pixel.x() >= -0.5 && pixel.x() < camera.width - 0.5 && pixel.y() >= -0.5 &&
                         pixel.y() < camera.height - 0.5;
  if (!is_inside) return std::nullopt;
  return pixel;
}

}  // namespace strata::volume
