// SPDX-License-Identifier: Apache-2.0
#include "core/volume/volume_map.hpp"

#include <cmath>
#include <limits>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <octomap/OcTree.h>
#include <octomap/ScanGraph.h>

#include "core/base/error.hpp"
#include "tests/core/volume/random_clouds.hpp"

namespace strata::volume {
namespace {

using test_clouds::room_cloud;

octomap::OcTree octomap_tree(const VolumeConfig& config) {
  octomap::OcTree tree(config.resolution_m);
  tree.setProbHit(config.probability_hit);
  tree.setProbMiss(config.probability_miss);
  tree.setClampingThresMin(config.min_probability);
  tree.setClampingThresMax(config.max_probability);
  return tree;
}

void insert_with_octomap(octomap::OcTree& tree, const Cloud& cloud, double max_range_m) {
  const auto& t = cloud.map_from_sensor.translation;
  const auto& q = cloud.map_from_sensor.rotation;
  const auto number = [](double value) { return static_cast<float>(value); };
  octomap::Pointcloud points;
  for (const Eigen::Vector3f& p : cloud.points_m) points.push_back(p.x(), p.y(), p.z());
  const octomap::pose6d pose(
      octomap::point3d(number(t.x()), number(t.y()), number(t.z())),
      octomath::Quaternion(number(q.w()), number(q.x()), number(q.y()), number(q.z())));
  octomap::ScanNode node(new octomap::Pointcloud(points), pose, 0);
  tree.insertPointCloud(node, max_range_m > 0.0 ? max_range_m : -1.0);
}

std::string bytes_of(const octomap::OcTree& tree) {
  std::ostringstream out;
  tree.write(out);
  return out.str();
}

struct Case {
  double resolution_m;
  double max_range_m;
  std::size_t clouds;
  std::size_t points;
};

class SameTree : public testing::TestWithParam<Case> {};

TEST_P(SameTree, AsOctomapBitByBitWithAnyNumberOfThreads) {
  VolumeConfig config;
  config.resolution_m = GetParam().resolution_m;
  config.max_range_m = GetParam().max_range_m;
  WorkerPool one(1);
  WorkerPool two(2);
  WorkerPool eight(8);
  VolumeMap with_one(config);
  VolumeMap with_two(config);
  VolumeMap with_eight(config);
  octomap::OcTree tree = octomap_tree(config);
  for (std::size_t i = 0; i < GetParam().clouds; ++i) {
    const Cloud cloud = room_cloud(7, i, GetParam().points);
    with_one.insert(cloud, {}, one);
    with_two.insert(cloud, {}, two);
    with_eight.insert(cloud, {}, eight);
    insert_with_octomap(tree, cloud, config.max_range_m);
    ASSERT_EQ(with_one.size().nodes, tree.size()) << "cloud " << i;
    ASSERT_EQ(with_one.full_file(), bytes_of(tree)) << "cloud " << i;
  }
  EXPECT_EQ(with_one.full_file(), with_two.full_file());
  EXPECT_EQ(with_one.full_file(), with_eight.full_file());
  EXPECT_EQ(with_one.size().leaves, tree.getNumLeafNodes());
  EXPECT_EQ(with_one.size().bytes, tree.memoryUsage());
}

// Many clouds reach the limits of the log odds, so that cubes are pruned and opened again.
INSTANTIATE_TEST_SUITE_P(VolumeMap, SameTree,
                         testing::Values(Case{0.1, 0.0, 3, 3000}, Case{0.05, 2.5, 2, 3000},
                                         Case{0.4, 0.0, 25, 400}, Case{0.2, 2.0, 25, 2000}));

TEST(VolumeMap, WritesTheFilesThatOctomapReads) {
  VolumeConfig config;
  WorkerPool pool(2);
  VolumeMap map(config);
  octomap::OcTree tree = octomap_tree(config);
  for (std::size_t i = 0; i < 4; ++i) {
    map.insert(room_cloud(3, i, 2000), {}, pool);
    insert_with_octomap(tree, room_cloud(3, i, 2000), 0.0);
  }
  std::ostringstream binary;
  octomap::OcTree likely(tree);
  likely.writeBinary(binary);
  EXPECT_EQ(map.binary_file(), binary.str());
  octomap::OcTree read(1.0);
  std::istringstream in(map.binary_file());
  ASSERT_TRUE(read.readBinary(in));
  EXPECT_EQ(read.getResolution(), 0.1);
  EXPECT_EQ(read.size(), likely.size());
  octomap::OcTree from_message(0.1);
  std::istringstream data(map.binary_message_data());
  from_message.readBinaryData(data);
  EXPECT_EQ(from_message.size(), likely.size());
}

Cloud one_point(const Eigen::Vector3f& point) {
  Cloud cloud;
  cloud.map_from_sensor.translation = {0.05, 0.05, 0.05};
  cloud.points_m = {point};
  return cloud;
}

TEST(VolumeMap, GivesAHitToTheEndAndAMissToWhatWasPassed) {
  WorkerPool pool(1);
  VolumeMap map(VolumeConfig{});
  const CloudCounts counts = map.insert(one_point({1.0F, 0.0F, 0.0F}), {}, pool);
  EXPECT_EQ(counts.voxels_ended, 1U);
  EXPECT_EQ(counts.voxels_passed, 10U);
  EXPECT_NEAR(map.log_odds({1.05, 0.05, 0.05}).value(), std::log(0.7 / 0.3), 1e-6);
  EXPECT_NEAR(map.log_odds({0.55, 0.05, 0.05}).value(), std::log(0.4 / 0.6), 1e-6);
  EXPECT_FALSE(map.log_odds({1.15, 0.05, 0.05}));
  EXPECT_TRUE(map.is_occupied(map.log_odds({1.05, 0.05, 0.05}).value()));
}

TEST(VolumeMap, EntersOnlyTheFreePartOfADynamicPoint) {
  WorkerPool pool(1);
  VolumeMap map(VolumeConfig{});
  const std::vector<std::uint8_t> is_dynamic{1};
  const CloudCounts counts = map.insert(one_point({1.0F, 0.0F, 0.0F}), is_dynamic, pool);
  EXPECT_EQ(counts.dynamic, 1U);
  EXPECT_EQ(counts.voxels_ended, 0U);
  EXPECT_FALSE(map.log_odds({1.05, 0.05, 0.05}));
  EXPECT_LT(map.log_odds({0.95, 0.05, 0.05}).value(), 0.0F);
}

TEST(VolumeMap, SkipsAndCountsPointsThatAreNoNumbers) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  WorkerPool pool(2);
  Cloud cloud = room_cloud(5, 0, 1000);
  VolumeMap clean(VolumeConfig{});
  clean.insert(cloud, {}, pool);
  cloud.points_m.insert(cloud.points_m.begin() + 500, {nan, 0.0F, 0.0F});
  cloud.points_m.push_back({0.0F, infinity, 0.0F});
  VolumeMap map(VolumeConfig{});
  EXPECT_EQ(map.insert(cloud, {}, pool).not_finite, 2U);
  EXPECT_EQ(map.full_file(), clean.full_file());
}

TEST(VolumeMap, RefusesAPoseThatIsNotFiniteAndStaysAsItWas) {
  WorkerPool pool(1);
  VolumeMap map(VolumeConfig{});
  map.insert(room_cloud(5, 0, 100), {}, pool);
  const std::string before = map.full_file();
  Cloud cloud = room_cloud(5, 1, 100);
  cloud.map_from_sensor.translation.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(map.insert(cloud, {}, pool), InputError);
  EXPECT_EQ(map.full_file(), before);
}

TEST(VolumeMap, CountsPointsOutsideTheLattice) {
  WorkerPool pool(1);
  VolumeMap map(VolumeConfig{});  // 6,553.6 m across
  EXPECT_EQ(map.insert(one_point({4000.0F, 0.0F, 0.0F}), {}, pool).outside, 1U);
  EXPECT_EQ(map.size().nodes, 0U);
}

/// Every voxel of a map, cubes taken apart.
std::set<std::pair<VoxelKey, float>> voxels_of(const VolumeMap& map, const VoxelBox& box) {
  std::set<std::pair<VoxelKey, float>> voxels;
  map.for_each_cube([&](const VoxelCube& cube) {
    for (std::int32_t z = 0; z < cube.edge; ++z) {
      for (std::int32_t y = 0; y < cube.edge; ++y) {
        for (std::int32_t x = 0; x < cube.edge; ++x) {
          const VoxelKey key{cube.corner.x + x, cube.corner.y + y, cube.corner.z + z};
          if (box.contains(key)) voxels.insert({key, cube.log_odds});
        }
      }
    }
  });
  return voxels;
}

TEST(VolumeMap, HoldsInsideABoxWhatTheUnboundedMapHoldsThere) {
  VolumeConfig config;
  VolumeConfig boxed = config;
  boxed.box_m = {-1.0, -3.5, -0.55, 3.05, 1.0, 1.0};
  WorkerPool pool(2);
  VolumeMap whole(config);
  VolumeMap part(boxed);
  for (std::size_t i = 0; i < 3; ++i) {
    whole.insert(room_cloud(9, i, 2000), {}, pool);
    part.insert(room_cloud(9, i, 2000), {}, pool);
  }
  const auto key = [](double x) { return kLatticeMiddle + static_cast<int>(std::floor(x * 10.0)); };
  const VoxelBox box{{key(-1.0), key(-3.5), key(-0.55)}, {key(3.05), key(1.0), key(1.0)}};
  const auto inside = voxels_of(part, VoxelBox{});
  EXPECT_GT(inside.size(), 10000U);
  EXPECT_EQ(inside, voxels_of(whole, box));
}

TEST(VolumeMap, RefusesSettingsThatMakeNoSense) {
  VolumeConfig config;
  config.resolution_m = 0.0;
  EXPECT_THROW(VolumeMap{config}, ConfigError);
  config = {};
  config.box_m = {0.0, 0.0, 0.0, 1.0, 1.0};
  EXPECT_THROW(VolumeMap{config}, ConfigError);
}

}  // namespace
}  // namespace strata::volume
