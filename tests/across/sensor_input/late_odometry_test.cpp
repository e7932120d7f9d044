// SPDX-License-Identifier: Apache-2.0
/// A robot whose odometry is stamped by another clock than its scans.
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/convert/geometry_messages.hpp"
#include "components/convert/scan_messages.hpp"
#include "components/runtime/sensor_input.hpp"
#include "core/random/stream.hpp"
#include "tests/across/sensor_input/recorded_robot.hpp"

namespace strata::runtime {
namespace {

using test::link;
using test::odometry;
using testing::HasSubstr;

constexpr double kRoomM = 6.0;
constexpr std::size_t kBeams = 180;

Pose2 pose_at(double s) {
  return {0.3 * std::sin(0.05 * s), 0.2,
          0.7 * std::sin(0.31 * s) + 0.4 * std::sin(0.83 * s + 1.0) + 0.2 * std::sin(1.9 * s)};
}

/// A scan of a square room around the origin, seen from where the robot is.
sensor_msgs::msg::LaserScan seen_at(double s, RandomStream& random) {
  Scan scan;
  scan.stamp = Stamp::from_seconds(s);
  scan.angle_increment_rad = static_cast<float>(M_PI / kBeams);
  scan.angle_min_rad = -0.5F * static_cast<float>(M_PI) + 0.5F * scan.angle_increment_rad;
  scan.range_min_m = 0.01F;
  scan.range_max_m = 20.0F;
  const Pose2 pose = pose_at(s);
  for (std::size_t i = 0; i < kBeams; ++i) {
    const double angle = pose.theta + scan.bearing_rad(i);
    const double dx = std::cos(angle);
    const double dy = std::sin(angle);
    const double to_x = ((dx > 0.0 ? kRoomM : -0.5 * kRoomM) - pose.x) / dx;
    const double to_y = ((dy > 0.0 ? 0.7 * kRoomM : -kRoomM) - pose.y) / dy;
    scan.ranges_m.push_back(static_cast<float>(std::min(to_x, to_y) + 0.01 * random.normal()));
  }
  return convert::to_message(scan, "laser");
}

struct Heard {
  std::vector<std::string> warnings;
  double worst_turn_rad = 0.0;  ///< of odometry against the truth, in the last third
  std::size_t scans = 0;
};

/// Two minutes of a robot that sends odometry at 50 Hz; one message of 20 is lost, one of 20 comes
/// late.
Heard drive(SensorInputConfig config, double lag_s) {
  SensorInput input(std::move(config), true);
  input.add(link(0.0, "base_link", "laser", {}));
  RandomStream random(7, StreamId::kTest, 0);
  Heard heard;
  double next_scan_s = 1.0;
  double offset = 0.0;
  std::vector<nav_msgs::msg::Odometry> late;
  for (double s = 0.0; s < 120.0; s += 0.02) {
    for (const auto& message : late) input.add(message);
    late.clear();
    const auto message = odometry(s + lag_s, pose_at(s));
    const double chance = random.uniform();
    if (chance < 0.05) {
      late.push_back(message);
    } else if (chance > 0.1) {
      input.add(message);
    }
    if (s >= next_scan_s) {
      input.add(seen_at(s, random));
      next_scan_s += 0.1;
    }
    for (const Observation& seen : input.take()) {
      input.watch_clock(seen);
      ++heard.scans;
      const double at_s = seen.scan.stamp.seconds();
      if (at_s < 80.0 || !seen.has_odometry) continue;
      offset = std::remainder(seen.odom_from_robot.theta - pose_at(at_s).theta, 2.0 * M_PI);
      heard.worst_turn_rad = std::max(heard.worst_turn_rad, std::abs(offset));
    }
    for (std::string& warning : input.take_warnings()) heard.warnings.push_back(warning);
  }
  return heard;
}

TEST(LateOdometry, IsNoticedByTurnsToldOnceAndCorrected) {
  for (const double lag_s : {-0.3, 0.17, 0.64}) {
    const Heard heard = drive({}, lag_s);
    ASSERT_EQ(heard.warnings.size(), 1U) << lag_s;
    EXPECT_THAT(heard.warnings[0], HasSubstr(lag_s > 0.0 ? "too late" : "too early"));
    EXPECT_LT(heard.worst_turn_rad, 0.06) << lag_s;
    EXPECT_GT(heard.scans, 1100U);
  }
}

TEST(LateOdometry, IsToldAloneWhereItMustNotBeCorrected) {
  SensorInputConfig config;
  config.correct_odometry_lag = false;
  const Heard heard = drive(config, 0.3);
  ASSERT_EQ(heard.warnings.size(), 1U);
  EXPECT_THAT(heard.warnings[0], HasSubstr("set odometry_lag_s: 0.3"));
  EXPECT_GT(heard.worst_turn_rad, 0.2);
}

TEST(LateOdometry, ThatIsKnownIsCorrectedFromTheStartAndNotTold) {
  SensorInputConfig config;
  config.odometry_lag_s = 0.3;
  const Heard heard = drive(config, 0.3);
  EXPECT_TRUE(heard.warnings.empty());
  EXPECT_LT(heard.worst_turn_rad, 0.06);
}

TEST(LateOdometry, IsNotSaidOfARobotWithOneClock) {
  const Heard heard = drive({}, 0.0);
  EXPECT_TRUE(heard.warnings.empty());
  EXPECT_LT(heard.worst_turn_rad, 0.06);
}

}  // namespace
}  // namespace strata::runtime
