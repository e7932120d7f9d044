// SPDX-License-Identifier: Apache-2.0
#include "tools/textures/textured_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
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

/// Squares along the edge of a sheet.
constexpr int kSheetSquares = 64;

/// Row and column of a square in its plane's frame.
using Place = std::pair<int, int>;

/// Squares on which a voxel of the plane may lie, row by row; at: columns by x, rows by y, whole
/// numbers in their middles [voxels]. O(voxels log voxels).
std::vector<Place> squares_near(const std::vector<Eigen::Vector2d>& at) {
  constexpr int kReach = 2;  // half a voxel's diagonal, and half a square
  Eigen::Vector2d high = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& point : at) high = high.cwiseMax(point);
  const auto columns = static_cast<int>(std::ceil(high.x() + 0.5));
  const auto rows = static_cast<int>(std::ceil(high.y() + 0.5));
  std::vector<Place> squares;
  for (const Eigen::Vector2d& point : at) {
    const auto column = static_cast<int>(std::lround(point.x()));
    const auto row = static_cast<int>(std::lround(point.y()));
    for (int y = std::max(row - kReach, 0); y <= std::min(row + kReach, rows - 1); ++y) {
      for (int x = std::max(column - kReach, 0); x <= std::min(column + kReach, columns - 1); ++x) {
        squares.emplace_back(y, x);
      }
    }
  }
  std::sort(squares.begin(), squares.end());
  squares.erase(std::unique(squares.begin(), squares.end()), squares.end());
  return squares;
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
  color_sheets();
}

void TextureMaker::cut(const Plane& plane, const VoxelIndex& index) {
  const double edge_m = lattice_.resolution_m();
  std::vector<Eigen::Vector2d> at;
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  for (const std::size_t i : plane.voxels) {
    const Eigen::Vector3d from = lattice_.center_m(voxels_[i].key) - plane.origin_m;
    at.emplace_back(from.dot(plane.u) / edge_m, from.dot(plane.v) / edge_m);
    low = low.cwiseMin(at.back());
  }
  for (Eigen::Vector2d& point : at) point -= low;
  const auto middle_m = [&](double x, double y) -> Eigen::Vector3d {
    return plane.origin_m + edge_m * ((low.x() + x) * plane.u + (low.y() + y) * plane.v);
  };
  // A square is there when its middle, or what is half a voxel off the plane, is in a voxel of it.
  const auto voxel_at = [&](const Eigen::Vector3d& square_m) {
    for (const double off : {0.0, 0.5, -0.5}) {
      const Eigen::Vector3d at_m = square_m + off * edge_m * plane.normal;
      const auto key = lattice_.key_at(at_m.cast<float>());
      const auto found = key ? index.find(*key) : index.end();
      if (found != index.end() &&
          std::binary_search(plane.voxels.begin(), plane.voxels.end(), found->second)) {
        return found;
      }
    }
    return index.end();
  };
  std::map<Place, Sheet> sheets;
  for (const auto& [y, x] : squares_near(at)) {
    const auto found = voxel_at(middle_m(x, y));
    if (found == index.end()) continue;
    sheets[{y / kSheetSquares, x / kSheetSquares}].squares.push_back({x, y, found->second});
  }
  for (auto& [place, sheet] : sheets) {
    int low_x = std::numeric_limits<int>::max();
    int low_y = low_x;
    for (const Square& square : sheet.squares) {
      low_x = std::min(low_x, square.x);
      low_y = std::min(low_y, square.y);
    }
    for (Square& square : sheet.squares) {
      square.x -= low_x;
      square.y -= low_y;
      sheet.width = std::max(sheet.width, square.x + 1);
      sheet.height = std::max(sheet.height, square.y + 1);
    }
    sheet.u = plane.u;
    sheet.v = plane.v;
    sheet.corner_m = middle_m(low_x - 0.5, low_y - 0.5);
    sheets_.push_back(std::move(sheet));
  }
}

void TextureMaker::place_sheets() {
  double area = 0.0;
  for (const Sheet& sheet : sheets_) area += static_cast<double>(sheet.width) * sheet.height;
  const int width = std::max(kSheetSquares, static_cast<int>(std::ceil(std::sqrt(area))));
  std::vector<Sheet*> order;
  for (Sheet& sheet : sheets_) order.push_back(&sheet);
  std::stable_sort(order.begin(), order.end(),
                   [](const Sheet* a, const Sheet* b) { return a->height > b->height; });
  int left = 0;
  int right = 1;
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
    right = std::max(right, left);
    shelf = std::max(shelf, sheet->height);
  }
  const int height = std::max(1, top + shelf);
  texels_ = std::min(config_.texels_per_voxel, config_.max_edge / std::max(right, height));
  if (texels_ == 0) {
    sheets_.clear();
    return;
  }
  texture_.width = right * texels_;
  texture_.height = height * texels_;
}

/// What a picture does not reach keeps the colour of its voxel.
void TextureMaker::color_sheets() {
  texture_.pixels.assign(
      static_cast<std::size_t>(texture_.width) * static_cast<std::size_t>(texture_.height),
      Rgb{128, 128, 128});
  for (const Sheet& sheet : sheets_) {
    for (const Square& square : sheet.squares) {
      for (int y = 0; y < texels_; ++y) {
        for (int x = 0; x < texels_; ++x) {
          texel(sheet, square, x, y) = voxels_[square.voxel].color;
        }
      }
    }
  }
}

Rgb& TextureMaker::texel(const Sheet& sheet, const Square& square, int x, int y) {
  const int texels = texels_;
  const int column = (sheet.left + square.x) * texels + x;
  const int row = (sheet.top + sheet.height - 1 - square.y) * texels + y;
  return texture_.pixels[static_cast<std::size_t>(row) * static_cast<std::size_t>(texture_.width) +
                         static_cast<std::size_t>(column)];
}

void TextureMaker::paint(const Sheet& sheet, const Square& square,
                         const volume::CameraView& picture, const Pose3& camera_from_map) {
  const int texels = texels_;
  const double edge_m = lattice_.resolution_m();
  for (int y = 0; y < texels; ++y) {
    for (int x = 0; x < texels; ++x) {
      const double along = square.x + (x + 0.5) / texels;
      const double up = square.y + 1.0 - (y + 0.5) / texels;
      const Eigen::Vector3d at_m =
          sheet.corner_m + along * edge_m * sheet.u + up * edge_m * sheet.v;
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
  const int texels = texels_;
  const double edge_m = lattice_.resolution_m();
  TexturedMesh mesh;
  mesh.texture = texture_;
  mesh.texels_per_voxel = texels_;
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
        polygon.corners_m[i] = sheet.corner_m + x * edge_m * sheet.u + y * edge_m * sheet.v;
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
