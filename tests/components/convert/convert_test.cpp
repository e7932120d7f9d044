// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "strata_idl/tf2_msgs.h"
#include <gtest/gtest.h>

#include "components/convert/cdr.hpp"
#include "components/convert/geometry_messages.hpp"
#include "components/convert/map_messages.hpp"
#include "components/convert/patch_messages.hpp"
#include "components/convert/scan_messages.hpp"
#include "core/base/error.hpp"

namespace strata::convert {
namespace {

Scan make_scan() {
  Scan scan;
  scan.stamp = {1663967375543607123};
  scan.angle_min_rad = -1.562069F;
  scan.angle_increment_rad = 0.0174533F;
  scan.range_min_m = 0.05F;
  scan.range_max_m = 80.0F;
  scan.ranges_m = {1.5F, std::numeric_limits<float>::infinity(), 0.1F,
                   std::numeric_limits<float>::quiet_NaN()};
  scan.robot_from_laser = {0.25, 0.0, 0.0};
  return scan;
}

TEST(Cdr, AScanKeepsEveryBit) {
  const Scan scan = make_scan();
  const auto bytes = to_cdr(to_message(scan, "laser"));
  EXPECT_EQ(bytes[0], 0);
  EXPECT_EQ(bytes[1], 1);
  const auto back =
      from_message(from_cdr<sensor_msgs::msg::LaserScan>(bytes, "test"), scan.robot_from_laser);
  EXPECT_EQ(back.stamp, scan.stamp);
  EXPECT_EQ(back.angle_min_rad, scan.angle_min_rad);
  ASSERT_EQ(back.size(), scan.size());
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(back.ranges_m[i], scan.ranges_m[i]);
  EXPECT_TRUE(std::isnan(back.ranges_m[3]));
}

TEST(Cdr, BytesOnTheWireAreThoseOfRos2) {
  // Taken from a bag of rosbag2: a transform odom -> base_link.
  tf2_msgs::msg::TFMessage message;
  message.transforms().push_back(
      to_transform_stamped({1000000000676914000}, {1.0, 0, 0}, "odom", "base_link"));
  const auto bytes = to_cdr(message);
  const std::vector<std::uint8_t> start = {
      0x00, 0x01, 0x00, 0x00, 0x01, 0x00, 0x00, 0x00, 0x00, 0xCA, 0x9A, 0x3B, 0x50, 0xE3,
      0x58, 0x28, 0x05, 0x00, 0x00, 0x00, 'o',  'd',  'o',  'm',  0x00, 0x00, 0x00, 0x00,
      0x0A, 0x00, 0x00, 0x00, 'b',  'a',  's',  'e',  '_',  'l',  'i',  'n',  'k',  0x00};
  ASSERT_GT(bytes.size(), start.size());
  EXPECT_EQ(std::vector<std::uint8_t>(bytes.begin(), bytes.begin() + 42), start);
}

TEST(Cdr, AnImpossibleLengthIsRefusedBeforeMemoryIsTaken) {
  auto bytes = to_cdr(to_message(make_scan(), "laser"));
  // Header 4, stamp 8, string 4 + 6 padded to 8, seven floats: the length of ranges follows.
  const std::size_t length_at = 4 + 8 + 4 + 8 + 28;
  ASSERT_EQ(bytes[length_at], 4);
  bytes[length_at + 3] = 0x7f;
  EXPECT_THROW((void)from_cdr<sensor_msgs::msg::LaserScan>(bytes, "test"), InputError);
}

TEST(Cdr, EveryCutIsRefused) {
  const auto bytes = to_cdr(to_message(make_scan(), "laser"));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const std::vector<std::uint8_t> cut(bytes.begin(),
                                        bytes.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_THROW((void)from_cdr<sensor_msgs::msg::LaserScan>(cut, "test"), InputError) << size;
  }
}

TEST(Geometry, StampsBefore1970KeepTheirNanoseconds) {
  for (const std::int64_t ns : {-1LL, -1000000000LL, -1500000000LL, 0LL, 1500000000LL}) {
    const auto time = to_message(Stamp{ns});
    EXPECT_LT(time.nanosec(), 1000000000U);
    EXPECT_EQ(from_message(time).ns, ns);
  }
}

TEST(Geometry, PosesAndCovariancesComeBack) {
  Pose2Gaussian gaussian;
  gaussian.mean = {1.5, -2.5, 3.0};
  gaussian.covariance << 1, 0.1, 0.2, 0.1, 2, 0.3, 0.2, 0.3, 3;
  const auto planar_back = from_message(to_pose_with_covariance(gaussian));
  EXPECT_NEAR(planar_back.mean.theta, 3.0, 1e-15);
  EXPECT_EQ(planar_back.covariance, gaussian.covariance);
  const auto exact = from_message(to_message(gaussian));
  EXPECT_EQ(exact.mean, gaussian.mean);
  EXPECT_EQ(exact.covariance, gaussian.covariance);
}

TEST(Maps, AnOccupancyGridKeepsCellsAndPlace) {
  ReflectionGrid grid = make_reflection_grid(0.05, {{-200, 30}, {-196, 33}});
  grid.at({-199, 31}) = 1.0F;
  grid.at({-198, 31}) = 0.0F;
  grid.at({-197, 32}) = 0.25F;
  const auto back = from_message(to_occupancy(grid, {0}, "map"));
  EXPECT_EQ(back.rect(), grid.rect());
  EXPECT_DOUBLE_EQ(back.resolution_m(), 0.05);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const float a = grid.values()[i];
    const float b = back.values()[i];
    EXPECT_TRUE(a == b || (std::isnan(a) && std::isnan(b))) << i;
  }
}

TEST(Maps, AGridThatDoesNotFillItsRectangleIsRefused) {
  strata_msgs::msg::ReflectionGrid message =
      to_message(make_reflection_grid(0.1, {{0, 0}, {2, 2}}));
  message.reflection().pop_back();
  EXPECT_THROW((void)from_message(message), InputError);
  message.rect().max_x(2'000'000'000);
  message.rect().min_x(-2'000'000'000);
  EXPECT_THROW((void)from_message(message), InputError);
}

TEST(Patches, APatchMapTravelsBitForBit) {
  patch::PatchMap map;
  map.base = make_reflection_grid(0.05, {{0, 0}, {3, 2}});
  map.base.values()[2] = 0.123456789F;
  patch::Submap submap;
  submap.rect = {{1, 0}, {3, 2}};
  submap.contradictory = Grid<std::uint8_t>(0.05, submap.rect);
  submap.contradictory.values()[1] = 1;
  patch::Configuration configuration;
  configuration.reflection = make_reflection_grid(0.05, submap.rect);
  configuration.counts = Grid<CellCounts>(0.05, submap.rect);
  configuration.counts.values()[3] = {1.0 / 3.0, 2.0 / 3.0};
  configuration.prior = 1.0;
  submap.configurations.push_back(configuration);
  submap.sequences.push_back({2, {5}, {9}, 17, {1.0}});
  map.submaps.push_back(submap);
  const auto bytes = to_cdr(to_message(map, {7}, "map"));
  const auto back = from_message(from_cdr<strata_msgs::msg::PatchMap>(bytes, "test"));
  EXPECT_EQ(to_cdr(to_message(back, {7}, "map")), bytes);
  EXPECT_EQ(back.base.values()[2], 0.123456789F);
  ASSERT_EQ(back.submaps.size(), 1U);
  EXPECT_EQ(back.submaps[0].configurations[0].counts.values()[3].hits, 1.0 / 3.0);
  EXPECT_EQ(back.submaps[0].sequences[0].scans, 17U);
}

}  // namespace
}  // namespace strata::convert
