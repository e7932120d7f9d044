// SPDX-License-Identifier: Apache-2.0
#include "tools/report/volume_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <Eigen/Geometry>

namespace strata::report {
namespace {

constexpr double kNearest_m = 0.05;

/// A pixel position and the distance along the view.
using Projected = Eigen::Vector3d;

class Canvas {
 public:
  Canvas(const VolumeView& view)
      : view_(view),
        image_(view.width, view.height),
        depth_(static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height),
               std::numeric_limits<float>::infinity()) {
    forward_ = (view.towards_m - view.from_m).normalized();
    // Looking straight down, north is up.
    const Eigen::Vector3d up =
        std::abs(forward_.z()) > 0.999 ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitZ();
    right_ = forward_.cross(up).normalized();
    up_ = right_.cross(forward_);
    is_parallel_ = view.field_of_view_rad <= 0.0;
    scale_ = is_parallel_ ? view.width / view.width_m
                          : 0.5 * view.width / std::tan(0.5 * view.field_of_view_rad);
  }

  /// The face of a cube on the side `axis` (0 to 2) and `sign`, when it looks at the camera.
  void face(const ColoredCube& cube, int axis, int sign) {
    const Eigen::Vector3d normal = Eigen::Vector3d::Unit(axis) * sign;
    Eigen::Vector3d corner = cube.corner_m;
    if (sign > 0) corner[axis] += cube.edge_m;
    const Eigen::Vector3d u = Eigen::Vector3d::Unit((axis + 1) % 3) * cube.edge_m;
    const Eigen::Vector3d v = Eigen::Vector3d::Unit((axis + 2) % 3) * cube.edge_m;
    const Eigen::Vector3d towards = is_parallel_ ? forward_ : corner - view_.from_m;
    if (normal.dot(towards) >= 0.0) return;
    std::array<Projected, 4> p;
    const std::array<Eigen::Vector3d, 4> corners{corner, corner + u, corner + u + v, corner + v};
    for (std::size_t i = 0; i < 4; ++i) {
      p[i] = project(corners[i]);
      if (!is_parallel_ && p[i].z() < kNearest_m) return;
    }
    const double light = 0.62 + 0.38 * std::abs(normal.dot(Eigen::Vector3d(0.36, 0.48, 0.8)));
    const auto shade = [light](std::uint8_t c) { return static_cast<std::uint8_t>(c * light); };
    const Color color{shade(cube.color.r), shade(cube.color.g), shade(cube.color.b)};
    triangle(p[0], p[1], p[2], color);
    triangle(p[0], p[2], p[3], color);
  }

  [[nodiscard]] Image take() && { return std::move(image_); }

 private:
  [[nodiscard]] Projected project(const Eigen::Vector3d& point) const {
    const Eigen::Vector3d offset = point - view_.from_m;
    const double depth = offset.dot(forward_);
    const double scale = is_parallel_ ? scale_ : scale_ / std::max(depth, kNearest_m);
    return {0.5 * view_.width + offset.dot(right_) * scale,
            0.5 * view_.height - offset.dot(up_) * scale, depth};
  }

  void triangle(const Projected& a, const Projected& b, const Projected& c, Color color) {
    const auto cross = [](const Projected& o, const Projected& p, double x, double y) {
      return (p.x() - o.x()) * (y - o.y()) - (p.y() - o.y()) * (x - o.x());
    };
    const double area = cross(a, b, c.x(), c.y());
    if (area == 0.0) return;
    const auto low = [](double value) { return std::max(0, static_cast<int>(std::floor(value))); };
    const auto clip = [](double value) { return std::clamp(value, -1.0, 1e6); };
    const int x0 = low(clip(std::min({a.x(), b.x(), c.x()})));
    const int y0 = low(clip(std::min({a.y(), b.y(), c.y()})));
    const int x1 =
        std::min(view_.width - 1, static_cast<int>(clip(std::max({a.x(), b.x(), c.x()}))));
    const int y1 =
        std::min(view_.height - 1, static_cast<int>(clip(std::max({a.y(), b.y(), c.y()}))));
    for (int y = y0; y <= y1; ++y) {
      for (int x = x0; x <= x1; ++x) {
        const double wa = cross(b, c, x + 0.5, y + 0.5) / area;
        const double wb = cross(c, a, x + 0.5, y + 0.5) / area;
        const double wc = 1.0 - wa - wb;
        // A little more than the triangle, or seams between neighbours shine through.
        if (wa < -1e-6 || wb < -1e-6 || wc < -1e-6) continue;
        const auto depth = static_cast<float>(wa * a.z() + wb * b.z() + wc * c.z());
        float& nearest =
            depth_[static_cast<std::size_t>(y) * static_cast<std::size_t>(view_.width) +
                   static_cast<std::size_t>(x)];
        if (depth >= nearest) continue;
        nearest = depth;
        image_.set(x, y, color);
      }
    }
  }

  VolumeView view_;
  Image image_;
  std::vector<float> depth_;
  Eigen::Vector3d forward_, right_, up_;
  bool is_parallel_ = true;
  double scale_ = 1.0;
};

/// Lowest and highest corner of all cubes.
std::array<Eigen::Vector3d, 2> bounds(std::span<const ColoredCube> cubes) {
  if (cubes.empty()) return {Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones()};
  Eigen::Vector3d low = cubes.front().corner_m;
  Eigen::Vector3d high = low;
  for (const ColoredCube& cube : cubes) {
    low = low.cwiseMin(cube.corner_m);
    high = high.cwiseMax(cube.corner_m + Eigen::Vector3d::Constant(cube.edge_m));
  }
  return {low, high};
}

}  // namespace

Color height_color(double share) {
  const volume::Rgb rgb = volume::height_rgb(share);
  return {rgb.r, rgb.g, rgb.b};
}

std::vector<ColoredCube> occupied_cubes(const volume::VolumeMap& map, double ceiling_m) {
  std::vector<ColoredCube> cubes;
  const double resolution = map.lattice().resolution_m();
  map.for_each_cube([&](const volume::VoxelCube& cube) {
    if (!cube.is_occupied) return;
    ColoredCube drawn;
    drawn.corner_m =
        map.lattice().center_m(cube.corner) - Eigen::Vector3d::Constant(0.5 * resolution);
    drawn.edge_m = cube.edge * resolution;
    if (drawn.corner_m.z() + drawn.edge_m <= ceiling_m) cubes.push_back(drawn);
  });
  const auto [low, high] = bounds(cubes);
  const double span = std::max(high.z() - low.z(), resolution);
  for (ColoredCube& cube : cubes) {
    cube.color = height_color((cube.corner_m.z() - low.z()) / span);
  }
  return cubes;
}

std::vector<ColoredCube> colored_cubes(const volume::ColorMap& colors,
                                       const volume::VoxelLattice& lattice, double ceiling_m) {
  std::vector<ColoredCube> cubes;
  const double edge_m = lattice.resolution_m();
  for (const volume::ColoredVoxel& voxel : colors.voxels()) {
    ColoredCube cube;
    cube.corner_m = lattice.center_m(voxel.key) - Eigen::Vector3d::Constant(0.5 * edge_m);
    cube.edge_m = edge_m;
    cube.color = {voxel.color.r, voxel.color.g, voxel.color.b};
    if (cube.corner_m.z() + edge_m <= ceiling_m) cubes.push_back(cube);
  }
  return cubes;
}

Image draw_cubes(std::span<const ColoredCube> cubes, const VolumeView& view) {
  Canvas canvas(view);
  for (const ColoredCube& cube : cubes) {
    for (int axis = 0; axis < 3; ++axis) {
      canvas.face(cube, axis, -1);
      canvas.face(cube, axis, 1);
    }
  }
  return std::move(canvas).take();
}

VolumeView view_from_above(std::span<const ColoredCube> cubes, int max_pixels) {
  const auto [low, high] = bounds(cubes);
  const Eigen::Vector3d size = high - low;
  VolumeView view;
  view.towards_m = 0.5 * (low + high);
  view.from_m = view.towards_m + Eigen::Vector3d(0.0, 0.0, size.z() + 1.0);
  view.width_m = 1.04 * size.x();
  const double pixels_per_m = max_pixels / (1.04 * std::max(size.x(), size.y()));
  view.width = std::max(16, static_cast<int>(view.width_m * pixels_per_m));
  view.height = std::max(16, static_cast<int>(1.04 * size.y() * pixels_per_m));
  return view;
}

VolumeView view_from_outside(std::span<const ColoredCube> cubes, double azimuth_rad,
                             double elevation_rad, int max_pixels) {
  const auto [low, high] = bounds(cubes);
  const double reach = (high - low).norm();
  const Eigen::Vector3d outward(std::cos(azimuth_rad) * std::cos(elevation_rad),
                                std::sin(azimuth_rad) * std::cos(elevation_rad),
                                std::sin(elevation_rad));
  VolumeView view;
  view.towards_m = 0.5 * (low + high);
  view.from_m = view.towards_m + outward * (reach + 1.0);
  // As wide and high as the corners of the bounds are in this view.
  const Eigen::Vector3d right = Eigen::Vector3d::UnitZ().cross(outward).normalized();
  const Eigen::Vector3d up = outward.cross(right);
  const auto extent = [&](const Eigen::Vector3d& axis) {
    return axis.cwiseAbs().dot(high - low) * 1.04;
  };
  view.width_m = std::max(0.1, extent(right));
  const double height_m = std::max(0.1, extent(up));
  const double pixels_per_m = max_pixels / std::max(view.width_m, height_m);
  view.width = std::max(16, static_cast<int>(view.width_m * pixels_per_m));
  view.height = std::max(16, static_cast<int>(height_m * pixels_per_m));
  return view;
}

}  // namespace strata::report
