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

constexpr double kBack_s = 8.0;

class ClockOfScanMatcher : public MappingRobot {
 protected:
  /// The way up to that scan.
  void drive_until(std::size_t scans) {
    begin("");
    before_ = drive({way_.log.begin(), way_.log.begin() + at(scans)}).size();
  }
  /// A part of the way, by a clock that was set back.
  [[nodiscard]] std::vector<Observation> set_back(std::size_t from, std::size_t to) const {
    return by_clock({way_.log.begin() + at(from), way_.log.begin() + at(to)}, -kBack_s);
  }
  /// How far a pose that was told after that is from where the robot was.
  [[nodiscard]] double error_m(const ScanPose& first, const ScanPose& pose) const {
    const Pose2 truth = between(way_.truth(first), way_.truth(pose, -kBack_s));
    return translation_distance(between(pose_of(first), pose_of(pose)), truth);
  }
  static std::ptrdiff_t at(std::size_t scan) { return static_cast<std::ptrdiff_t>(scan); }

  const Drive way_;
  std::size_t before_ = 0;  ///< poses told before that
};

// As NTP sets it when it comes late: the robot drives on, and so does its odometry.
TEST_F(ClockOfScanMatcher, ThatIsSetBackWhileItDrivesCostsItNeitherPlaceNorMap) {
  const std::size_t middle = way_.log.size() / 2;
  drive_until(middle);
  const std::vector<ScanPose> told = drive(set_back(middle, way_.log.size()));
  ASSERT_GT(told.size(), before_ + 50U);
  for (std::size_t i = before_; i < told.size(); ++i) {
    ASSERT_EQ(told[i].run(), 1);
    ASSERT_LT(error_m(told.front(), told[i]), 0.3) << told[i].index();
  }
  EXPECT_THAT(host_->take_errors(), testing::Contains(testing::HasSubstr("was set back")));
}

TEST_F(ClockOfScanMatcher, ThatIsSetBackWhileItsScannerIsBlindCostsItNoPlace) {
  drive_until(100);
  std::vector<Observation> rest = set_back(100, 160);
  for (std::size_t i = 0; i < 4; ++i) {
    std::ranges::fill(rest[i].scan.ranges_m, std::numeric_limits<float>::quiet_NaN());
  }
  const std::vector<ScanPose> told = drive(rest);
  ASSERT_EQ(told.size(), before_ + 56);
  EXPECT_LT(error_m(told.front(), told.back()), 0.3);
}

// Where the map knows nothing of what is seen, odometry that has gone on tells.
TEST_F(ClockOfScanMatcher, ThatIsSetBackWhereTheScanFitsNowhereIsBridgedByOdometry) {
  drive_until(100);
  std::vector<Observation> rest = set_back(100, 105);
  for (Observation& observation : rest) {
    for (float& range_m : observation.scan.ranges_m) range_m *= 0.4F;
  }
  const std::vector<ScanPose> told = drive(rest);
  ASSERT_GT(told.size(), before_);
  EXPECT_EQ(told[before_].run(), 1);
  EXPECT_LT(error_m(told.front(), told[before_]), 0.3);
}

TEST_F(ClockOfScanMatcher, GoesOnWhileTheScannerIsBlindWithoutAPoseThatNobodySaw) {
  std::vector<Observation> log{way_.log.begin(), way_.log.begin() + 60};
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
