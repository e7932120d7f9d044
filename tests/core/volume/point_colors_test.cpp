// SPDX-License-Identifier: Apache-2.0
#include "core/volume/point_colors.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/error.hpp"

namespace strata::volume {
namespace {

constexpr Rgb kPureRed{255, 0, 0};
constexpr Rgb kBlue{0, 0, 255};

Cloud cloud_with(const std::vector<Eigen::Vector3f>& points, const std::vector<Rgb>& colors) {
  Cloud cloud;
  cloud.map_from_sensor.translation = {0.05, 0.05, 0.05};
  cloud.points_m = points;
  cloud.colors = colors;
  return cloud;
}

VoxelKey key_at(float x) { return VoxelLattice(0.1).key_at({x, 0.05F, 0.05F}).value(); }

TEST(PointColors, AreTheMeanOfCloudsWhateverTheirPoints) {
  WorkerPool pool(1);
  PointColors colors({});
  EXPECT_TRUE(colors.is_empty());
  colors.add(cloud_with({{1.0F, 0.0F, 0.0F}}, {kBlue}), {}, pool);
  const std::vector<Eigen::Vector3f> three{
      {1.0F, 0.0F, 0.0F}, {1.01F, 0.0F, 0.0F}, {1.0F, 0.01F, 0.0F}};
  colors.add(cloud_with(three, {kPureRed, kPureRed, kPureRed}), {}, pool);
  EXPECT_EQ(colors.color(key_at(1.05F)), (Rgb{128, 0, 128}));
  EXPECT_FALSE(colors.color(key_at(2.05F)));
  EXPECT_FALSE(colors.color(key_at(1.15F))) << "a voxel of the same brick";
  for (int i = 0; i < 200; ++i)
    colors.add(cloud_with(three, {kPureRed, kPureRed, kPureRed}), {}, pool);
  EXPECT_EQ(colors.color(key_at(1.05F)), kPureRed) << "what was long ago fades";
}

TEST(PointColors, LeaveOutWhatMovesLiesTooFarOrHasNoColour) {
  WorkerPool pool(1);
  VolumeConfig config;
  config.max_range_m = 3.0;
  PointColors colors(config);
  const std::vector<Eigen::Vector3f> points{
      {1.0F, 0.0F, 0.0F}, {2.0F, 0.0F, 0.0F}, {4.0F, 0.0F, 0.0F}};
  const std::vector<std::uint8_t> is_dynamic{0, 1, 0};
  colors.add(cloud_with(points, {kPureRed, kPureRed, kPureRed}), is_dynamic, pool);
  EXPECT_EQ(colors.color(key_at(1.05F)), kPureRed);
  EXPECT_FALSE(colors.color(key_at(2.05F)));
  EXPECT_FALSE(colors.color(key_at(4.05F)));
  colors.add(cloud_with(points, {}), {}, pool);
  colors.add(cloud_with(points, {kBlue}), {}, pool);  // too few
  EXPECT_EQ(colors.color(key_at(1.05F)), kPureRed);
  EXPECT_FALSE(colors.color(key_at(2.05F)));
}

TEST(PointColors, FollowTheirPointsIntoParts) {
  WorkerPool pool(1);
  Cloud cloud = cloud_with({{1.0F, 0.0F, 0.0F}, {2.0F, 0.0F, 0.0F}}, {kPureRed, kBlue});
  const std::vector<float> offset_s{0.5F, 0.0F};  // the first was measured last
  const Pose3 pose = cloud.map_from_sensor;
  ASSERT_EQ(cut_by_time(cloud, offset_s, 0.1, [&](Stamp) { return pose; }), 0U);
  PointColors colors({});
  colors.add(cloud, {}, pool);
  EXPECT_EQ(colors.color(key_at(1.05F)), kPureRed);
  EXPECT_EQ(colors.color(key_at(2.05F)), kBlue);
}

TEST(PointColors, ComeBackFromTheirFileAndRefuseOthers) {
  WorkerPool pool(1);
  const Cloud cloud = cloud_with({{1.0F, 0.0F, 0.0F}, {2.0F, 0.5F, 0.0F}}, {kPureRed, kBlue});
  VolumeMap map(VolumeConfig{});
  map.insert(cloud, {}, pool);
  map.insert(cloud_with({{-1.0F, 0.0F, 0.0F}}, {}), {}, pool);
  PointColors colors({});
  colors.add(cloud, {}, pool);
  const std::string file = colors.file(map);
  PointColors again({});
  again.restore(file, "colors");
  EXPECT_EQ(again.color(key_at(1.05F)), kPureRed);
  EXPECT_FALSE(again.color(key_at(-0.95F))) << "grey says nothing";
  EXPECT_EQ(again.file(map), file);
  for (std::size_t length = 0; length < file.size(); length += 7) {
    EXPECT_THROW(again.restore(file.substr(0, length), "cut"), InputError) << length;
  }
  EXPECT_THROW(again.restore(map.full_file(), "without colours"), InputError);
  EXPECT_THROW(again.restore(map.binary_file(), "without colours"), InputError);
  VolumeConfig coarse;
  coarse.resolution_m = 0.2;
  EXPECT_THROW(PointColors(coarse).restore(file, "fine"), InputError);
}

}  // namespace
}  // namespace strata::volume
