// SPDX-License-Identifier: Apache-2.0
/// Polygons with pictures on them: what [stachniss2003chapter, figure 1.10] shows.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/volume/camera.hpp"
#include "core/volume/color_map.hpp"
#include "tools/textures/planes.hpp"

namespace strata::textures {

struct TextureConfig {
  PlaneConfig planes;
  int texels_per_voxel = 4;
  int max_edge = 8192;

  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.group("planes", c.planes, "the flat surfaces of the map");
    v.field("texels_per_voxel", c.texels_per_voxel,
            {.doc = "pixels of the texture along the edge of a voxel", .min = 1, .max = 8});
    v.field("max_edge", c.max_edge,
            {.doc = "a texture that would be wider or higher has fewer pixels a voxel; graphics "
                    "cards refuse larger ones",
             .unit = "pixels",
             .min = 1,
             .max = 65536});
  }
};

/// A rectangle in space and where its picture lies in the texture.
struct TexturedPolygon {
  std::array<Eigen::Vector3d, 4> corners_m;        ///< around it
  std::array<Eigen::Vector2d, 4> corners_texture;  ///< of the same [pixels], y down
};

struct TexturedMesh {
  std::vector<TexturedPolygon> polygons;
  volume::ColorImage texture;
  int texels_per_voxel = 0;
  std::size_t voxels = 0;  ///< of the map that lie in polygons
  std::size_t texels = 0;  ///< of polygons
  std::size_t seen = 0;    ///< ... of squares whose voxel a picture showed
};

/// Cuts the planes of a coloured map into squares of a voxel, each with the picture that the colour
/// of its voxel came from: the one that most likely shows static things only. Two rounds: the
/// pictures were offered to the ColorMap; then they come again. Time and memory by the surface, not
/// by the box around it: a plane is cut into sheets of 64 squares a side, where there are any.
class TextureMaker {
 public:
  /// Squares whose voxel no picture showed are grey. Throws ConfigError. Keeps a reference to the
  /// map's voxels.
  TextureMaker(const TextureConfig& config, const volume::ColorMap& colors,
               const volume::VoxelLattice& lattice);

  /// Whether there is more surface than a texture of max_edge holds with one pixel a square: the
  /// mesh is empty then.
  [[nodiscard]] bool is_too_large() const { return texels_ == 0; }

  /// view: which of the pictures offered to the ColorMap this one was, from 0. O(squares).
  void add(std::int32_t view, const volume::CameraView& picture);
  /// Squares side by side are joined to rectangles. O(squares).
  [[nodiscard]] TexturedMesh mesh() const;

 private:
  struct Square {
    int x = 0;  ///< in its sheet, voxels from the lower left corner
    int y = 0;
    std::size_t voxel = 0;
  };
  struct Sheet {
    Eigen::Vector3d u = Eigen::Vector3d::UnitX();  ///< along its rows
    Eigen::Vector3d v = Eigen::Vector3d::UnitY();
    Eigen::Vector3d corner_m = Eigen::Vector3d::Zero();  ///< of square (0, 0)
    int width = 0;                                       ///< squares
    int height = 0;
    int left = 0;  ///< in the texture, squares
    int top = 0;
    std::vector<Square> squares;
  };
  void cut(const Plane& plane, const VoxelIndex& index);
  void place_sheets();
  void color_sheets();
  void paint(const Sheet& sheet, const Square& square, const volume::CameraView& picture,
             const Pose3& camera_from_map);
  [[nodiscard]] volume::Rgb& texel(const Sheet& sheet, const Square& square, int x, int y);

  TextureConfig config_;
  volume::VoxelLattice lattice_;
  std::span<const volume::ColoredVoxel> voxels_;
  std::vector<Sheet> sheets_;
  volume::ColorImage texture_;
  int texels_ = 0;  ///< along the edge of a square
};

}  // namespace strata::textures
