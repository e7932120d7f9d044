// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "tests/tools/textures/painted_wall.hpp"
#include "tools/textures/glb.hpp"
#include "tools/textures/textured_mesh.hpp"

namespace strata::textures {
namespace {

using test_wall::kBlue;
using test_wall::kGreen;
using test_wall::kRed;
using test_wall::looking;
using test_wall::Wall;

/// What of a texture is of that colour.
std::size_t count(const TexturedMesh& mesh, const volume::Rgb& color) {
  std::size_t times = 0;
  for (const volume::Rgb& texel : mesh.texture.pixels) times += texel == color ? 1 : 0;
  return times;
}

TEST(Textures, AreOnePolygonWithThePictureTheRightWayRound) {
  const Wall wall;
  TextureMaker maker({}, wall.colors, wall.map.lattice());
  maker.add(0, looking(0.05, wall.first));
  maker.add(1, looking(40.0, wall.second));
  const TexturedMesh mesh = maker.mesh();
  ASSERT_EQ(mesh.polygons.size(), 1U);
  EXPECT_EQ(mesh.voxels, 19U * 11U);
  EXPECT_EQ(mesh.texels, 19U * 11U * 16U);
  EXPECT_EQ(mesh.seen, mesh.texels);
  EXPECT_EQ(count(mesh, kBlue), 0U);
  EXPECT_GT(count(mesh, kRed), 800U);
  EXPECT_GT(count(mesh, kGreen), 800U);
  // Left of the camera is +y: every red texel lies there, seen in space.
  for (const report::ColoredCube& cube :
       texel_cubes(mesh, std::numeric_limits<double>::infinity())) {
    const double y = cube.corner_m.y() + 0.5 * cube.edge_m;
    if (cube.color == report::Color{200, 0, 0}) {
      EXPECT_GT(y, 0.04);
    }
    if (cube.color == report::Color{0, 200, 0}) {
      EXPECT_LT(y, 0.06);
    }
    const double z = cube.corner_m.z() + 0.5 * cube.edge_m;
    EXPECT_EQ((cube.color == report::Color{90, 90, 90}), z > 1.15) << z;
    EXPECT_NEAR(cube.corner_m.x() + 0.5 * cube.edge_m, 3.05, 1e-6);
  }
}

TEST(Textures, OfAPictureThatNoVoxelTookAreNotPainted) {
  const Wall wall;
  TextureMaker maker({}, wall.colors, wall.map.lattice());
  maker.add(7, looking(0.05, wall.second));
  EXPECT_EQ(count(maker.mesh(), kBlue), 0U);
}

TEST(Textures, CubesEndAtTheCeiling) {
  const Wall wall;
  const TextureMaker maker({}, wall.colors, wall.map.lattice());
  const auto cubes = texel_cubes(maker.mesh(), 1.0);
  EXPECT_EQ(cubes.size(), 19U * 16U * 5U);  // from 0.5 to 1.0 m
}

/// A floor of two arms, 3 voxels wide and `length` long, at a right angle.
volume::VolumeMap map_of_two_arms(int length) {
  WorkerPool pool(1);
  volume::VolumeMap map(volume::VolumeConfig{});
  volume::Cloud cloud;
  cloud.map_from_sensor.translation = {0.05, 0.05, 2.05};
  for (int along = 0; along < length; ++along) {
    for (int across = 0; across < 3; ++across) {
      const float far_m = 0.1F * static_cast<float>(along);
      const float side_m = 0.1F * static_cast<float>(across);
      cloud.points_m.emplace_back(far_m, side_m, -2.0F);
      cloud.points_m.emplace_back(side_m, far_m, -2.0F);
    }
  }
  for (int i = 0; i < 3; ++i) map.insert(cloud, {}, pool);
  return map;
}

TEST(Textures, TakeRoomByTheSurfaceAndNotByTheBoxAroundIt) {
  constexpr int kLength = 180;
  const volume::VolumeMap map = map_of_two_arms(kLength);
  const volume::ColorMap colors({}, map, {});
  const TexturedMesh mesh = TextureMaker({}, colors, map.lattice()).mesh();
  EXPECT_EQ(mesh.voxels, 6U * kLength - 9U);
  EXPECT_EQ(mesh.texels, 16U * mesh.voxels);
  // The corner's sheet is a square of 64; the box around all has 180 x 180 squares.
  EXPECT_LT(mesh.texture.pixels.size(), 16U * 64U * 80U);
  // Joined again they are the floor: every square once, where it is.
  std::set<std::pair<int, int>> squares;
  for (const report::ColoredCube& cube :
       texel_cubes(mesh, std::numeric_limits<double>::infinity())) {
    const Eigen::Vector3d at = cube.corner_m + Eigen::Vector3d::Constant(0.5 * cube.edge_m);
    EXPECT_NEAR(at.z(), 0.05, 1e-6);
    squares.emplace(static_cast<int>(std::floor(at.x() / 0.1)),
                    static_cast<int>(std::floor(at.y() / 0.1)));
  }
  EXPECT_EQ(squares.size(), mesh.voxels);
  for (const auto& [x, y] : squares) {
    EXPECT_TRUE(x >= 0 && y >= 0 && std::min(x, y) < 3 && std::max(x, y) < kLength)
        << x << " " << y;
  }
}

TEST(Textures, OfAWallAcrossTheLatticeHaveNoHoles) {
  WorkerPool pool(1);
  volume::VolumeMap map(volume::VolumeConfig{});
  volume::Cloud cloud;
  cloud.map_from_sensor.translation = {0.05, 0.05, 1.05};
  constexpr int kSteps = 20;
  for (int i = 0; i < kSteps; ++i) {
    for (int z = -5; z <= 5; ++z) {  // from (3.05, 0.05) in the direction of (1, 1)
      const float along_m = 0.1F * static_cast<float>(i);
      cloud.points_m.emplace_back(3.0F + along_m, along_m, 0.1F * static_cast<float>(z));
    }
  }
  for (int i = 0; i < 3; ++i) map.insert(cloud, {}, pool);
  const volume::ColorMap colors({}, map, {});
  const TexturedMesh mesh = TextureMaker({}, colors, map.lattice()).mesh();
  ASSERT_EQ(mesh.voxels, 11U * kSteps);
  // One rectangle, as long as the wall.
  ASSERT_EQ(mesh.polygons.size(), 1U);
  const auto& corners_m = mesh.polygons[0].corners_m;
  EXPECT_NEAR((corners_m[1] - corners_m[0]).norm(), std::sqrt(2.0) * 0.1 * (kSteps - 1), 0.15);
  EXPECT_NEAR((corners_m[3] - corners_m[0]).norm(), 1.1, 1e-9);
}

TextureConfig with_edge(int pixels) {
  TextureConfig config;
  config.max_edge = pixels;
  return config;
}

TEST(Textures, AreNoLargerThanViewersShow) {
  const Wall wall;
  TextureConfig fine;
  fine.texels_per_voxel = 8;
  const TexturedMesh mesh = TextureMaker(fine, wall.colors, wall.map.lattice()).mesh();
  EXPECT_EQ(mesh.texels_per_voxel, 8);
  const TexturedMesh coarse =
      TextureMaker(with_edge(19 * 3 + 2), wall.colors, wall.map.lattice()).mesh();
  EXPECT_EQ(coarse.texels_per_voxel, 3);
  EXPECT_EQ(coarse.texture.width, 19 * 3);
  EXPECT_EQ(coarse.voxels, mesh.voxels);
  const TextureMaker one_pixel(with_edge(19), wall.colors, wall.map.lattice());
  EXPECT_FALSE(one_pixel.is_too_large());
  const TextureMaker none(with_edge(18), wall.colors, wall.map.lattice());
  EXPECT_TRUE(none.is_too_large());
  EXPECT_TRUE(none.mesh().polygons.empty());
}

TEST(Textures, OfMuchSurfaceAreDrawnWithCubesOfManyTexels) {
  const Wall wall;
  const TexturedMesh mesh = TextureMaker({}, wall.colors, wall.map.lattice()).mesh();
  const double all = std::numeric_limits<double>::infinity();
  const auto fine = texel_cubes(mesh, all);
  ASSERT_EQ(fine.size(), mesh.texels);
  const auto coarse = texel_cubes(mesh, all, mesh.texels - 1);
  EXPECT_EQ(coarse.size(), mesh.texels / 4);
  EXPECT_NEAR(coarse.front().edge_m, 2.0 * fine.front().edge_m, 1e-12);
}

}  // namespace
}  // namespace strata::textures
