// SPDX-License-Identifier: Apache-2.0
#include "tools/textures/textured_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace strata::textures {
namespace {

using volume::Rgb;

Rgb mixed(const volume::ColorImage& image, const Eigen::Vector2d& at) {
  const double x = std::clamp(at.x(), 0.0, image.width - 1.0);
  const double y = std::clamp(at.y(), 0.0, image.height - 1.0);
  const auto x0 = static_cast<int>(x);
  const auto y0 = static_cast<int>(y);
  const int x1 = std::min(x0 + 1, image.width - 1);
  const int y1 = std::min(y0 + 1, image.height - 1);
  const double right = x - x0;
  const double low = y - y0;
  const auto mix = [&](std::uint8_t Rgb::*channel) {
    const auto of = [&](int u, int v) { return static_cast<double>(image.at(u, v).*channel); };
    const double value = (1.0 - low) * ((1.0 - right) * of(x0, y0) + right * of(x1, y0)) +
                         low * ((1.0 - right) * of(x0, y1) + right * of(x1, y1));
    return static_cast<std::uint8_t>(std::lround(value));
  };
  return {mix(&Rgb::r), mix(&Rgb::g), mix(&Rgb::b)};
}

/// Rectangles of squares that are there, row by row from below.
struct Tile {
  int x0, y0, x1, y1;  ///< squares, the upper ones outside
};
std::vector<Tile> tiles_of(int width, int height, std::vector<std::uint8_t> is_there) {
  const auto at = [&](int x, int y) -> std::uint8_t& {
    return is_there[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                    static_cast<std::size_t>(x)];
  };
  std::vector<Tile> tiles;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (at(x, y) == 0) continue;
      Tile tile{x, y, x, y + 1};
      while (tile.x1 < width && at(tile.x1, y) != 0) ++tile.x1;
      const auto is_row = [&](int row) {
        for (int i = tile.x0; i < tile.x1; ++i) {
          if (at(i, row) == 0) return false;
        }
        return true;
      };
      while (tile.y1 < height && is_row(tile.y1)) ++tile.y1;
      for (int row = tile.y0; row < tile.y1; ++row) {
        for (int i = tile.x0; i < tile.x1; ++i) at(i, row) = 0;
      }
      tiles.push_back(tile);
    }
  }
  return tiles;
}

}  // namespace

TextureMaker::TextureMaker(const TextureConfig& config, const volume::ColorMap& colors,
                           const volume::VoxelLattice& lattice)
    : config_(config), lattice_(lattice), voxels_(colors.voxels()) {
  require_valid(config, "textures");
  const VoxelIndex index = index_of(voxels_);
  for (const Plane& plane : find_planes(voxels_, lattice, config.planes)) cut(plane, index);
  place_sheets();
}

void TextureMaker::cut(const Plane& plane, const VoxelIndex& index) {
  const double edge_m = lattice_.resolution_m();
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector2d high = -low;
  for (const std::size_t i : plane.voxels) {
    const Eigen::Vector3d from = lattice_.center_m(voxels_[i].key) - plane.origin_m;
    const Eigen::Vector2d at(from.dot(plane.u), from.dot(plane.v));
    low = low.cwiseMin(at);
    high = high.cwiseMax(at);
  }
  Sheet sheet;
  sheet.plane = plane;
  low -= Eigen::Vector2d::Constant(0.5 * edge_m);
  sheet.corner_m = plane.origin_m + low.x() * plane.u + low.y() * plane.v;
  sheet.width = static_cast<int>(std::ceil((high.x() - low.x()) / edge_m));
  sheet.height = static_cast<int>(std::ceil((high.y() - low.y()) / edge_m));
  // A square is there when its middle, or what is half a voxel off the plane, is in a voxel of it.
  const auto voxel_at = [&](const Eigen::Vector3d& middle_m) {
    for (const double off : {0.0, 0.5, -0.5}) {
      const Eigen::Vector3d at_m = middle_m + off * edge_m * plane.normal;
      const auto key = lattice_.key_at(at_m.cast<float>());
      const auto found = key ? index.find(*key) : index.end();
      if (found != index.end() &&
          std::binary_search(plane.voxels.begin(), plane.voxels.end(), found->second)) {
        return found;
      }
    }
    return index.end();
  };
  for (int y = 0; y < sheet.height; ++y) {
    for (int x = 0; x < sheet.width; ++x) {
      const auto found =
          voxel_at(sheet.corner_m + (x + 0.5) * edge_m * plane.u + (y + 0.5) * edge_m * plane.v);
      if (found != index.end()) sheet.squares.push_back({x, y, found->second});
    }
  }
  if (!sheet.squares.empty()) sheets_.push_back(std::move(sheet));
}

void TextureMaker::place_sheets() {
  double area = 0.0;
  int width = 1;
  for (const Sheet& sheet : sheets_) {
    area += static_cast<double>(sheet.width) * sheet.height;
    width = std::max(width, sheet.width);
  }
  width = std::max(width, static_cast<int>(std::ceil(std::sqrt(area))));
  std::vector<Sheet*> order;
  for (Sheet& sheet : sheets_) order.push_back(&sheet);
  std::stable_sort(order.begin(), order.end(),
                   [](const Sheet* a, const Sheet* b) { return a->height > b->height; });
  int left = 0;
  int top = 0;
  int shelf = 0;
  for (Sheet* sheet : order) {
    if (left + sheet->width > width) {
      left = 0;
      top += shelf;
      shelf = 0;
    }
    sheet->left = left;
    sheet->top = top;
    left += sheet->width;
    shelf = std::max(shelf, sheet->height);
  }
  const int texels = config_.texels_per_voxel;
  texture_.width = width * texels;
  texture_.height = std::max(1, top + shelf) * texels;
  texture_.pixels.assign(
      static_cast<std::size_t>(texture_.width) * static_cast<std::size_t>(texture_.height),
      Rgb{128, 128, 128});
  // What a picture does not reach keeps the colour of its voxel.
  for (const Sheet& sheet : sheets_) {
    for (const Square& square : sheet.squares) {
      for (int y = 0; y < texels; ++y) {
        for (int x = 0; x < texels; ++x) {
          texel(sheet, square, x, y) = voxels_[square.voxel].color;
        }
      }
    }
  }
}

Rgb& TextureMaker::texel(const Sheet& sheet, const Square& square, int x, int y) {
  const int texels = config_.texels_per_voxel;
  const int column = (sheet.left + square.x) * texels + x;
  const int row = (sheet.top + sheet.height - 1 - square.y) * texels + y;
  return texture_.pixels[static_cast<std::size_t>(row) * static_cast<std::size_t>(texture_.width) +
                         static_cast<std::size_t>(column)];
}

void TextureMaker::paint(const Sheet& sheet, const Square& square,
                         const volume::CameraView& picture, const Pose3& camera_from_map) {
  const int texels = config_.texels_per_voxel;
  const double edge_m = lattice_.resolution_m();
  for (int y = 0; y < texels; ++y) {
    for (int x = 0; x < texels; ++x) {
      const double along = square.x + (x + 0.5) / texels;
      const double up = square.y + 1.0 - (y + 0.5) / texels;
      const Eigen::Vector3d at_m =
          sheet.corner_m + along * edge_m * sheet.plane.u + up * edge_m * sheet.plane.v;
      const auto pixel = volume::project(picture.camera, camera_from_map * at_m);
      if (pixel) texel(sheet, square, x, y) = mixed(*picture.image, *pixel);
    }
  }
}

void TextureMaker::add(std::int32_t view, const volume::CameraView& picture) {
  const Pose3 camera_from_map = inverse(picture.map_from_camera);
  for (const Sheet& sheet : sheets_) {
    for (const Square& square : sheet.squares) {
      if (voxels_[square.voxel].view == view) paint(sheet, square, picture, camera_from_map);
    }
  }
}

TexturedMesh TextureMaker::mesh() const {
  const int texels = config_.texels_per_voxel;
  const double edge_m = lattice_.resolution_m();
  TexturedMesh mesh;
  mesh.texture = texture_;
  std::vector<std::uint8_t> is_shown(voxels_.size(), 0);
  for (const Sheet& sheet : sheets_) {
    std::vector<std::uint8_t> is_there(
        static_cast<std::size_t>(sheet.width) * static_cast<std::size_t>(sheet.height), 0);
    for (const Square& square : sheet.squares) {
      is_there[static_cast<std::size_t>(square.y) * static_cast<std::size_t>(sheet.width) +
               static_cast<std::size_t>(square.x)] = 1;
      is_shown[square.voxel] = 1;
      const auto in_square = static_cast<std::size_t>(texels) * static_cast<std::size_t>(texels);
      mesh.texels += in_square;
      if (voxels_[square.voxel].is_seen()) mesh.seen += in_square;
    }
    for (const Tile& tile : tiles_of(sheet.width, sheet.height, std::move(is_there))) {
      const std::array<std::pair<int, int>, 4> corners{
          {{tile.x0, tile.y0}, {tile.x1, tile.y0}, {tile.x1, tile.y1}, {tile.x0, tile.y1}}};
      TexturedPolygon polygon;
      for (std::size_t i = 0; i < corners.size(); ++i) {
        const auto [x, y] = corners[i];
        polygon.corners_m[i] =
            sheet.corner_m + x * edge_m * sheet.plane.u + y * edge_m * sheet.plane.v;
        polygon.corners_texture[i] = {static_cast<double>((sheet.left + x) * texels),
                                      static_cast<double>((sheet.top + sheet.height - y) * texels)};
      }
      mesh.polygons.push_back(polygon);
    }
  }
  mesh.voxels = static_cast<std::size_t>(std::count(is_shown.begin(), is_shown.end(), 1));
  return mesh;
}

}  // namespace strata::textures
