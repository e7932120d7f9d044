// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/base/error.hpp"
#include "tools/textures/glb.hpp"

namespace strata::textures {
namespace {

using volume::ColoredVoxel;
using volume::VoxelKey;

const volume::VoxelLattice kLattice(0.1);

std::int32_t middle(int at) { return volume::kLatticeMiddle + at; }

void add(std::vector<ColoredVoxel>& voxels, int x, int y, int z) {
  ColoredVoxel voxel;
  voxel.key = VoxelKey{middle(x), middle(y), middle(z)};
  voxels.push_back(voxel);
}

/// A floor of 20 x 20 voxels and a wall of 12 on its edge at x = 0, which share a row.
std::vector<ColoredVoxel> corner() {
  std::vector<ColoredVoxel> voxels;
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 20; ++x) add(voxels, x, y, 0);
    for (int z = 1; z < 12; ++z) add(voxels, 0, y, z);
  }
  return voxels;
}

TEST(Planes, AreTheFloorAndTheWallWithTheRowThatTheyShare) {
  const auto voxels = corner();
  const std::vector<Plane> planes = find_planes(voxels, kLattice, {});
  ASSERT_EQ(planes.size(), 2U);
  EXPECT_NEAR(std::abs(planes[0].normal.z()), 1.0, 1e-3);
  EXPECT_NEAR(std::abs(planes[1].normal.x()), 1.0, 1e-3);
  EXPECT_EQ(planes[0].voxels.size(), 400U);
  EXPECT_EQ(planes[1].voxels.size(), 240U);
  for (const Plane& plane : planes) {
    EXPECT_NEAR(plane.u.cross(plane.v).dot(plane.normal), 1.0, 1e-9);
  }
  EXPECT_NEAR(planes[1].u.z(), 0.0, 1e-9) << "u is level on a wall";
  EXPECT_NEAR(planes[0].origin_m.z(), 0.05, 1e-9);
}

TEST(Planes, LeaveOutWhatIsSmallAndWhatIsNotFlat) {
  std::vector<ColoredVoxel> voxels;
  for (int i = 0; i < 5; ++i) {
    for (int j = 0; j < 5; ++j) add(voxels, i, j, 0);  // 25, five fewer than asked
  }
  EXPECT_TRUE(find_planes(voxels, kLattice, {}).empty());
  PlaneConfig smaller;
  smaller.min_voxels = 25;
  EXPECT_EQ(find_planes(voxels, kLattice, smaller).size(), 1U);
  std::vector<ColoredVoxel> block;
  for (int x = 0; x < 8; ++x) {
    for (int y = 0; y < 8; ++y) {
      for (int z = 0; z < 8; ++z) add(block, x, y, z);
    }
  }
  for (const Plane& plane : find_planes(block, kLattice, {})) EXPECT_LT(plane.voxels.size(), 130U);
  EXPECT_TRUE(find_planes({}, kLattice, {}).empty());
  PlaneConfig wrong;
  wrong.min_voxels = 0;
  EXPECT_THROW((void)find_planes(voxels, kLattice, wrong), ConfigError);
}

/// A wall at x = 3.05, |y| < 1, seen from the origin at 1 m height.
volume::VolumeMap map_of_wall() {
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
volume::CameraView looking(double x, const volume::ColorImage& image) {
  volume::CameraView view;
  view.map_from_camera.translation = {x, 0.05, 1.05};
  Eigen::Matrix3d axes;
  axes << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  view.map_from_camera.rotation = Eigen::Quaterniond(axes);
  view.camera = {200, 200, 200.0, 200.0, 99.5, 99.5, {}};
  view.image = &image;
  return view;
}

constexpr volume::Rgb kRed{200, 0, 0};
constexpr volume::Rgb kGreen{0, 200, 0};
constexpr volume::Rgb kBlue{0, 0, 200};
constexpr volume::Rgb kGrey{90, 90, 90};

/// Grey in the upper rows, above 1.15 m on the wall, in the midst of a voxel; below it two halves.
volume::ColorImage halves(volume::Rgb left, volume::Rgb right) {
  volume::ColorImage image{200, 200, {}};
  for (int i = 0; i < 200 * 200; ++i) {
    const volume::Rgb half = i % 200 < 100 ? left : right;
    image.pixels.push_back(i / 200 < 93 ? kGrey : half);
  }
  return image;
}

/// What of a texture is of that colour.
std::size_t count(const TexturedMesh& mesh, const volume::Rgb& color) {
  std::size_t times = 0;
  for (const volume::Rgb& texel : mesh.texture.pixels) times += texel == color ? 1 : 0;
  return times;
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

std::uint32_t number_at(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

TEST(Glb, HoldsPolygonsAndPictureWhereItsJsonSays) {
  const Wall wall;
  TextureMaker maker({}, wall.colors, wall.map.lattice());
  maker.add(0, looking(0.05, wall.first));
  const TexturedMesh mesh = maker.mesh();
  const std::string file = glb_of(mesh);
  ASSERT_EQ(file.substr(0, 4), "glTF");
  EXPECT_EQ(number_at(file, 4), 2U);
  EXPECT_EQ(number_at(file, 8), file.size());
  const std::size_t length = number_at(file, 12);
  ASSERT_EQ(file.substr(16, 4), "JSON");
  const auto json = nlohmann::json::parse(file.substr(20, length));
  const std::size_t binary = 20 + length + 8;
  ASSERT_EQ(file.substr(binary - 4, 3), "BIN");
  EXPECT_EQ(binary + number_at(file, binary - 8), file.size());
  EXPECT_EQ(json["buffers"][0]["byteLength"], file.size() - binary);
  ASSERT_EQ(json["nodes"].size(), 1U);
  EXPECT_EQ(json["nodes"][0]["mesh"], 0);
  EXPECT_EQ(json["scenes"][0]["nodes"][0], 0);
  const auto& primitive = json["meshes"][0]["primitives"][0];
  const auto view = [&](const nlohmann::json& accessor) {
    return json["bufferViews"]
               [json["accessors"][accessor.get<std::size_t>()]["bufferView"].get<std::size_t>()];
  };
  EXPECT_EQ(json["accessors"][primitive["attributes"]["POSITION"].get<std::size_t>()]["count"], 4);
  const std::size_t places = view(primitive["attributes"]["POSITION"])["byteOffset"];
  float x = 0.0F;
  std::memcpy(&x, file.data() + binary + places, sizeof x);
  EXPECT_NEAR(x, 3.05F, 1e-6F);
  const std::size_t indices = view(primitive["indices"])["byteOffset"];
  EXPECT_EQ(number_at(file, binary + indices + 4 * 5), 3U);
  const std::size_t image =
      json["bufferViews"][json["images"][0]["bufferView"].get<std::size_t>()]["byteOffset"];
  EXPECT_EQ(file.substr(binary + image + 1, 3), "PNG");
  EXPECT_EQ(json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"], 0);
  EXPECT_EQ(json["textures"][0]["source"], 0);
}

}  // namespace
}  // namespace strata::textures
