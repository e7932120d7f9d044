// SPDX-License-Identifier: Apache-2.0
#include "core/scan/cloud_slice.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace strata {
namespace {

constexpr float kNoPoint = std::numeric_limits<float>::quiet_NaN();
constexpr double kPi = std::numbers::pi;

/// The beam that points there, in the frame of the laser.
std::size_t beam_at(const Scan& scan, double bearing_rad) {
  const double place = (bearing_rad - static_cast<double>(scan.angle_min_rad)) /
                       static_cast<double>(scan.angle_increment_rad);
  return static_cast<std::size_t>(std::lround(place)) % scan.size();
}

std::size_t hits(const Scan& scan) { return count_beams(scan).hits; }

TEST(CloudSlice, TakesTheNearestPointBetweenTheHeightsInEachDirection) {
  // A mast of 1 m: what is 0.8 to 0.5 m below the sensor is in the slice.
  const Pose3 mast{{0.2, 0.0, 1.0}, Eigen::Quaterniond::Identity()};
  const std::vector<Eigen::Vector3f> points{{3.0F, 0.0F, -0.7F},
                                            {2.0F, 0.0F, -0.6F},
                                            {1.0F, 0.0F, -0.9F},  // the last: the floor
                                            {1.5F, 0.0F, 0.4F},   // above
                                            {0.0F, 4.0F, -0.6F},
                                            {0.1F, 0.1F, -0.6F},  // itself
                                            {kNoPoint, kNoPoint, kNoPoint},
                                            {-50.0F, 0.0F, -0.6F}};
  const CloudSlice slice = slice_cloud(points, {}, Stamp{7}, mast, {});
  const Scan& scan = slice.scan;
  EXPECT_EQ(scan.stamp, Stamp{7});
  EXPECT_TRUE(slice.offset_s.empty());
  EXPECT_EQ(hits(scan), 2U);
  EXPECT_FLOAT_EQ(scan.ranges_m[beam_at(scan, 0.0)], 2.0F);
  EXPECT_FLOAT_EQ(scan.ranges_m[beam_at(scan, kPi / 2.0)], 4.0F);
  EXPECT_EQ(count_beams(scan).invalid, scan.size() - 2);
  EXPECT_EQ(scan.robot_from_laser, (Pose2{0.2, 0.0, 0.0}));
  EXPECT_NEAR(scan.bearing_rad(scan.size()) - scan.bearing_rad(0), 2.0 * kPi, 1e-4);
}

TEST(CloudSlice, PutsPointsWhereTheyAreWhateverTheAttitude) {
  const Eigen::Vector3d wall(2.5, -1.0, 0.4);  // in the robot's frame
  for (const double yaw : {0.0, 1.0, -2.5}) {
    for (const double pitch : {0.0, 0.3}) {
      for (const double roll : {0.0, kPi}) {
        const Eigen::Quaterniond attitude = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
                                            Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) *
                                            Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX());
        const Pose3 mounting{{-0.3, 0.1, 0.6}, attitude};
        const std::vector<Eigen::Vector3f> points{(inverse(mounting) * wall).cast<float>()};
        const Scan scan = slice_cloud(points, {}, {}, mounting, {}).scan;
        ASSERT_EQ(hits(scan), 1U);
        for (std::size_t i = 0; i < scan.size(); ++i) {
          if (scan.kind(i) != BeamKind::kHit) continue;
          const auto range = static_cast<double>(scan.ranges_m[i]);
          const double bearing = scan.bearing_rad(i);
          const Eigen::Vector2d seen =
              scan.robot_from_laser *
              Eigen::Vector2d(range * std::cos(bearing), range * std::sin(bearing));
          EXPECT_LT((seen - wall.head<2>()).norm(), 3.0 * 0.0087);
        }
      }
    }
  }
}

TEST(CloudSlice, KeepsTheTimeOfEachBeamsPoint) {
  const Pose3 mounting{{0.0, 0.0, 0.4}, Eigen::Quaterniond::Identity()};
  const std::vector<Eigen::Vector3f> points{
      {3.0F, 0.0F, 0.0F}, {2.0F, 0.0F, 0.0F}, {0.0F, 1.0F, 0.0F}};
  const std::vector<float> offset_s{0.01F, 0.02F, 0.03F};
  const CloudSlice slice = slice_cloud(points, offset_s, {}, mounting, {});
  ASSERT_EQ(slice.offset_s.size(), slice.scan.size());
  EXPECT_EQ(slice.offset_s[beam_at(slice.scan, 0.0)], 0.02F);
  EXPECT_EQ(slice.offset_s[beam_at(slice.scan, kPi / 2.0)], 0.03F);
}

}  // namespace
}  // namespace strata
