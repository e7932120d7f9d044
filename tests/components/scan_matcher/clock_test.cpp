// SPDX-License-Identifier: Apache-2.0
/// A scan matcher whose robot's clock is set, or whose scanner goes blind.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/components/scan_matcher/mapping_robot.hpp"

namespace strata::scan_matcher {
namespace {

using ClockOfScanMatcher = MappingRobot;

std::vector<Observation> by_clock(std::vector<Observation> log, double later_s) {
  for (Observation& observation : log) {
    observation.scan.stamp = observation.scan.stamp + Duration::from_seconds(later_s);
  }
  return log;
}

// As NTP sets it when it comes late: the robot drives on, and so does its odometry.
TEST_F(ClockOfScanMatcher, ThatIsSetBackWhileItDrivesCostsItNeitherPlaceNorMap) {
  constexpr double kBack_s = 8.0;
  const Drive way;
  const auto middle = way.log.begin() + static_cast<std::ptrdiff_t>(way.log.size() / 2);
  begin("");
  const std::size_t before = drive({way.log.begin(), middle}).size();
  const std::vector<ScanPose> told = drive(by_clock({middle, way.log.end()}, -kBack_s));
  ASSERT_GT(told.size(), before + 50U);
  const ScanPose& first = told.front();
  for (auto pose = told.begin() + static_cast<std::ptrdiff_t>(before); pose != told.end(); ++pose) {
    ASSERT_EQ(pose->run(), 1);
    const Pose2 truth = between(way.truth(first), way.truth(*pose, -kBack_s));
    ASSERT_LT(translation_distance(between(pose_of(first), pose_of(*pose)), truth), 0.3)
        << pose->index();
  }
  EXPECT_THAT(host_->take_errors(), testing::Contains(testing::HasSubstr("was set back")));
}

TEST_F(ClockOfScanMatcher, ThatIsSetBackWhileItsScannerIsBlindCostsItNoPlace) {
  constexpr double kBack_s = 8.0;
  const Drive way;
  const auto middle = way.log.begin() + 100;
  begin("");
  const std::size_t before = drive({way.log.begin(), middle}).size();
  auto rest = by_clock({middle, middle + 60}, -kBack_s);
  for (std::size_t i = 0; i < 4; ++i) {
    std::ranges::fill(rest[i].scan.ranges_m, std::numeric_limits<float>::quiet_NaN());
  }
  const std::vector<ScanPose> told = drive(rest);
  ASSERT_EQ(told.size(), before + 56);
  const Pose2 truth = between(way.truth(told.front()), way.truth(told.back(), -kBack_s));
  EXPECT_LT(translation_distance(between(pose_of(told.front()), pose_of(told.back())), truth), 0.3);
}

// Where the map knows nothing of what is seen, odometry that has gone on tells.
TEST_F(ClockOfScanMatcher, ThatIsSetBackWhereTheScanFitsNowhereIsBridgedByOdometry) {
  constexpr double kBack_s = 8.0;
  const Drive way;
  const auto middle = way.log.begin() + 100;
  begin("");
  const std::size_t before = drive({way.log.begin(), middle}).size();
  auto rest = by_clock({middle, middle + 5}, -kBack_s);
  for (Observation& observation : rest) {
    for (float& range_m : observation.scan.ranges_m) range_m *= 0.4F;
  }
  const std::vector<ScanPose> told = drive(rest);
  ASSERT_GT(told.size(), before);
  const ScanPose& first = told[before];
  EXPECT_EQ(first.run(), 1);
  const Pose2 truth = between(way.truth(told.front()), way.truth(first, -kBack_s));
  EXPECT_LT(translation_distance(between(pose_of(told.front()), pose_of(first)), truth), 0.3);
}

TEST_F(ClockOfScanMatcher, GoesOnWhileTheScannerIsBlindWithoutAPoseThatNobodySaw) {
  const Drive way;
  std::vector<Observation> log{way.log.begin(), way.log.begin() + 60};
  constexpr std::size_t kBlind = 50;
  for (std::size_t i = kBlind; i < kBlind + 5; ++i) {
    std::ranges::fill(log[i].scan.ranges_m, std::numeric_limits<float>::quiet_NaN());
  }
  test::Collector<tf2_msgs::msg::TFMessage> transforms(participant_, "/tf", "lossless");
  begin("");
  const std::vector<ScanPose> told = drive(log);
  EXPECT_EQ(told.size(), log.size() - 5);
  const auto stamp_of = [](const tf2_msgs::msg::TFMessage& message) {
    return convert::from_message(message.transforms().at(0).header().stamp());
  };
  const std::vector<tf2_msgs::msg::TFMessage> tf = transforms.wait_for(log.size());
  ASSERT_EQ(tf.size(), log.size());
  for (std::size_t i = kBlind; i < kBlind + 5; ++i) {
    EXPECT_EQ(stamp_of(tf[i]), log[i].scan.stamp);
    EXPECT_EQ(tf[i].transforms()[0].transform(), tf[kBlind - 1].transforms()[0].transform());
  }
}

}  // namespace
}  // namespace strata::scan_matcher
