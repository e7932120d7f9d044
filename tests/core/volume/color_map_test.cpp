// SPDX-License-Identifier: Apache-2.0
#include "core/volume/color_map.hpp"

#include <cmath>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <octomap/ColorOcTree.h>

#include "core/base/error.hpp"
#include "core/volume/point_colors.hpp"
#include "core/volume/voxel_memory.hpp"

namespace strata::volume {
namespace {

/// A wall at x = 3.05 and |y| < 1, seen from the origin at 1 m height.
Cloud wall(double x = 3.05) {
  Cloud cloud;
  cloud.map_from_sensor.translation = {0.05, 0.05, 1.05};
  for (int y = -9; y <= 9; ++y) {
    for (int z = -5; z <= 5; ++z) {
      cloud.points_m.push_back({static_cast<float>(x - 0.05), 0.1F * static_cast<float>(y),
                                0.1F * static_cast<float>(z)});
    }
  }
  return cloud;
}

VolumeMap map_of_wall() {
  WorkerPool pool(1);
  VolumeMap map(VolumeConfig{});
  for (int i = 0; i < 3; ++i) map.insert(wall(), {}, pool);
  return map;
}

/// A camera at (x, y, 1.05) that looks along x.
CameraView looking(double x, double y, double time_s, const ColorImage& image) {
  CameraView view;
  view.stamp = Stamp::from_seconds(time_s);
  view.map_from_camera.translation = {x, y, 1.05};
  Eigen::Matrix3d axes;
  axes << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  view.map_from_camera.rotation = Eigen::Quaterniond(axes);
  view.camera = {40, 40, 20.0, 20.0, 19.5, 19.5, {}};
  view.image = &image;
  return view;
}

ColorImage plain(Rgb color) { return {40, 40, std::vector<Rgb>(1600, color)}; }

constexpr Rgb kGreen{0, 200, 0};
constexpr Rgb kRed{200, 0, 0};

/// Of the voxel in which (3.05, y, 1.05) lies.
ColoredVoxel voxel_at(const ColorMap& colors, double y) {
  const VoxelLattice lattice(VolumeConfig{}.resolution_m);
  const auto key = lattice.key_at(Eigen::Vector3f(3.05F, static_cast<float>(y), 1.05F));
  for (const ColoredVoxel& voxel : colors.voxels()) {
    if (voxel.key == *key) return voxel;
  }
  ADD_FAILURE() << "no voxel";
  return {};
}

TEST(ColorMap, TakesThePictureInWhichNoOneStandsBeforeTheVoxel) {
  const VolumeMap map = map_of_wall();
  // At 10 s someone stands 1.5 m before the middle of the wall; the red picture is the more
  // frontal.
  std::vector<MovingWitness> witnesses;
  for (int i = 0; i < 3; ++i) {
    witnesses.push_back({Stamp::from_seconds(10.0), {1.5, 0.05}, std::log(0.1)});
  }
  ColorConfig narrow;
  narrow.margin_m = 0.2;
  ColorMap colors(narrow, map, witnesses);
  WorkerPool pool(2);
  const ColorImage red = plain(kRed);
  const ColorImage green = plain(kGreen);
  EXPECT_GT(colors.add(looking(0.05, 0.05, 10.0, red), pool), 100U);
  EXPECT_FALSE(voxel_at(colors, 0.05).is_seen());
  ColorConfig paper;
  paper.min_static = 0.0;
  ColorMap any(paper, map, witnesses);
  any.add(looking(0.05, 0.05, 10.0, red), pool);
  EXPECT_EQ(voxel_at(any, 0.05).color, kRed);  // better than nothing
  any.add(looking(0.05, 0.65, 20.0, green), pool);
  EXPECT_EQ(voxel_at(any, 0.05).color, kGreen);
  colors.add(looking(0.05, 0.65, 20.0, green), pool);
  EXPECT_EQ(voxel_at(colors, 0.05).color, kGreen);
  EXPECT_EQ(voxel_at(colors, -0.65).color, kRed);  // he hid nothing there: more frontal
  colors.add(looking(0.05, 0.05, 10.1, red), pool);
  EXPECT_EQ(voxel_at(colors, 0.05).color, kGreen);
}

TEST(ColorMap, LooksOverTheHeadsOfPeople) {
  const VolumeMap map = map_of_wall();
  std::vector<MovingWitness> witnesses{{Stamp::from_seconds(10.0), {1.5, 0.05}, std::log(0.1)}};
  ColorConfig config;
  config.highest_m = 1.0;  // a child, below the line of sight
  ColorMap colors(config, map, witnesses);
  WorkerPool pool(1);
  const ColorImage red = plain(kRed);
  colors.add(looking(0.05, 0.05, 10.0, red), pool);
  EXPECT_EQ(voxel_at(colors, 0.05).likelihood, 0);
}

TEST(ColorMap, ColoursNothingBehindAWall) {
  VolumeMap map = map_of_wall();
  WorkerPool pool(1);
  const ColorImage red = plain(kRed);
  ColorMap before({}, map, {});
  before.add(looking(0.05, 0.05, 0.0, red), pool);
  EXPECT_TRUE(voxel_at(before, 0.05).is_seen());
  for (int i = 0; i < 3; ++i) map.insert(wall(1.05), {}, pool);
  ColorMap behind({}, map, {});
  behind.add(looking(0.05, 0.05, 0.0, red), pool);
  EXPECT_FALSE(voxel_at(behind, 0.05).is_seen());
}

TEST(ColorMap, IsTheSameForAnyNumberOfThreads) {
  const VolumeMap map = map_of_wall();
  std::vector<std::string> files;
  for (const int threads : {1, 2, 8}) {
    WorkerPool pool(threads);
    ColorMap colors({}, map, {{Stamp{}, {1.5, 0.05}, -1.0}});
    ColorImage image = plain(kRed);
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
      image.pixels[i].b = static_cast<std::uint8_t>(i % 251);
    }
    colors.add(looking(0.05, 0.05, 0.0, image), pool);
    colors.add(looking(0.55, 0.35, 1.0, image), pool);
    files.push_back(colors.file(map));
  }
  EXPECT_TRUE(files[0] == files[1] && files[0] == files[2]);
}

TEST(ColorMap, WritesATreeThatOctomapReads) {
  const VolumeMap map = map_of_wall();
  ColorMap colors({}, map, {});
  colors.color_by_height();
  std::istringstream in(colors.file(map), std::ios::binary);
  const std::unique_ptr<octomap::AbstractOcTree> tree(octomap::AbstractOcTree::read(in));
  const auto* colored = dynamic_cast<const octomap::ColorOcTree*>(tree.get());
  ASSERT_NE(colored, nullptr);
  std::size_t checked = 0;
  for (const ColoredVoxel& voxel : colors.voxels()) {
    const Eigen::Vector3d p = map.lattice().center_m(voxel.key);
    const octomap::ColorOcTreeNode* node = colored->search(p.x(), p.y(), p.z());
    ASSERT_NE(node, nullptr);
    EXPECT_EQ(node->getLogOdds(), voxel.log_odds);
    EXPECT_EQ((Rgb{node->getColor().r, node->getColor().g, node->getColor().b}), voxel.color);
    ++checked;
  }
  EXPECT_EQ(checked, 19U * 11U);
  const octomap::ColorOcTreeNode* free = colored->search(1.05, 0.05, 1.05);
  ASSERT_NE(free, nullptr);
  EXPECT_EQ(free->getLogOdds(), map.log_odds({1.05, 0.05, 1.05}).value());
  EXPECT_EQ(colored->search(5.05, 0.05, 1.05), nullptr);
}

TEST(VolumeMap, IsReadBackFromItsFiles) {
  const VolumeMap map = map_of_wall();
  const VolumeMap full = VolumeMap::from_file(map.full_file(), "a.ot");
  EXPECT_TRUE(full.full_file() == map.full_file());
  const VolumeMap binary = VolumeMap::from_file(map.binary_file(), "a.bt");
  EXPECT_TRUE(binary.binary_file() == map.binary_file());
  std::string cut = map.full_file();
  cut.resize(cut.size() / 2);
  EXPECT_THROW((void)VolumeMap::from_file(cut, "a.ot"), InputError);
  EXPECT_THROW((void)VolumeMap::from_file("# Octomap OcTree file\nid ColorOcTree\ndata\n", "a"),
               InputError);
  EXPECT_THROW((void)VolumeMap::from_file("nonsense", "a"), InputError);
}

TEST(VolumeMap, IsReadBackWhereItsVoxelsHaveEdgesOfMoreDigitsThanAFile) {
  VolumeConfig config;
  config.resolution_m = 1.0 / 30.0;
  Cloud cloud;
  cloud.points_m = {{2.0F, 0.5F, 0.3F}};
  cloud.colors = {{200, 100, 50}};
  WorkerPool pool(1);
  VolumeMap map(config);
  map.insert(cloud, {}, pool);
  const VolumeMap again = VolumeMap::from_file(map.full_file(), "a.ot", config);
  EXPECT_EQ(again.config().resolution_m, config.resolution_m);
  EXPECT_EQ(again.full_file(), map.full_file());
  PointColors colors(config);
  colors.add(cloud, {}, pool);
  PointColors restored(config);
  EXPECT_NO_THROW(restored.restore(colors.file(map), "a_color.ot"));
  config.resolution_m = 0.0334;
  EXPECT_THROW((void)VolumeMap::from_file(map.full_file(), "a.ot", config), InputError);
}

TEST(VolumeMap, OfNothingIsReadBackToo) {
  const VolumeMap empty(VolumeConfig{});
  for (const std::string& file : {empty.full_file(), empty.binary_file()}) {
    EXPECT_EQ(VolumeMap::from_file(file, "a", VolumeConfig{}).size().nodes, 0U);
    VolumeConfig coarse;
    coarse.resolution_m = 0.5;
    EXPECT_THROW((void)VolumeMap::from_file(file, "a", coarse), InputError);
  }
}

TEST(VoxelMemory, TellsWhatAppearedAndWhatIsGone) {
  const VoxelLattice lattice(VolumeConfig{}.resolution_m);
  VoxelMemory memory({}, lattice, {});
  WorkerPool pool(2);
  for (int i = 0; i < 20; ++i) memory.observe(wall(3.05), {}, pool);
  EXPECT_TRUE(memory.changes().empty());
  for (int i = 0; i < 8; ++i) memory.observe(wall(2.05), {}, pool);
  // The far wall is out of sight: its voxels keep what was known, the near one appeared.
  auto changes = memory.changes();
  ASSERT_EQ(changes.size(), 1U);
  EXPECT_TRUE(changes[0].appeared);
  // Without those at the rim, which no ray passed before.
  EXPECT_GT(changes[0].voxels.size(), 80U);
  EXPECT_NEAR(lattice.center_m(changes[0].min.x), 2.05, 1e-6);
  const auto key = lattice.key_at(Eigen::Vector3f(2.05F, 0.05F, 1.05F)).value();
  const double brief = memory.occupancy(key, VoxelLevel::kShort).value();
  const double middle = memory.occupancy(key, VoxelLevel::kMid).value();
  const double lasting = memory.occupancy(key, VoxelLevel::kLong).value();
  // 8 of 28 clouds: the long level is still their mean, the short one forgot the others.
  EXPECT_NEAR(lasting, 8.0 / 28.0, 1e-3);
  EXPECT_NEAR(brief, 1.0 - std::exp2(-4.0), 1e-3);
  EXPECT_GT(brief, middle);
  EXPECT_GT(middle, lasting);
  for (int i = 0; i < 12; ++i) memory.observe(wall(3.05), {}, pool);
  changes = memory.changes();
  EXPECT_TRUE(changes.empty());  // it was away for so long, and so short there, that neither counts
  EXPECT_FALSE(memory.occupancy(lattice.key_at({9.0F, 0.0F, 1.0F}).value(), VoxelLevel::kShort));
}

TEST(VoxelMemory, StatesItsMemory) {
  VoxelMemory memory({}, VoxelLattice(VolumeConfig{}.resolution_m), {});
  WorkerPool pool(1);
  memory.observe(wall(), {}, pool);
  EXPECT_GT(memory.known_voxels(), 500U);
  // Seven bytes in whole bricks of 512.
  EXPECT_GE(memory.bytes(), 7 * memory.known_voxels());
}

TEST(VoxelMemory, DoesNotRememberWhatMoves) {
  const VoxelLattice lattice(VolumeConfig{}.resolution_m);
  VoxelMemory memory({}, lattice, {});
  WorkerPool pool(1);
  const Cloud cloud = wall();
  const std::vector<std::uint8_t> all(cloud.points_m.size(), 1);
  for (int i = 0; i < 5; ++i) memory.observe(cloud, all, pool);
  const auto key = lattice.key_at(Eigen::Vector3f(3.05F, 0.05F, 1.05F)).value();
  EXPECT_FALSE(memory.occupancy(key, VoxelLevel::kShort));
}

}  // namespace
}  // namespace strata::volume
