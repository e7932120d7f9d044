// SPDX-License-Identifier: Apache-2.0
/// A scan matcher whose process ends and begins again.
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/components/scan_matcher/mapping_robot.hpp"

namespace strata::scan_matcher {
namespace {

class StoredScanMatcher : public MappingRobot {
 protected:
  [[nodiscard]] std::filesystem::path file() const { return folder_.path() / "slam.state"; }
  void begin() { MappingRobot::begin("store: {file: '" + file().string() + "', period_s: 1}"); }
  [[nodiscard]] std::size_t kept_scans() const {
    slam::Slam slam{slam::SlamConfig{}};
    slam.restore_state(log::read_state_file(file()), file().string());
    return slam.kept_scans();
  }
  /// A process that ends in the middle of the way.
  std::vector<ScanPose> drive_half() {
    begin();
    auto told = drive({way_.log.begin(), way_.log.begin() + middle()});
    end();
    return told;
  }
  [[nodiscard]] std::ptrdiff_t middle() const {
    return static_cast<std::ptrdiff_t>(way_.log.size() / 2);
  }

  const Drive way_;
};

TEST_F(StoredScanMatcher, GoesOnInItsMapWithTheOdometryThatWentOn) {
  const std::vector<Observation>& log = way_.log;
  const auto first = drive_half();
  ASSERT_FALSE(first.empty());
  const std::size_t kept_before = kept_scans();
  EXPECT_GT(kept_before, 0U);
  begin();
  // Some scans were missed while it was away_.
  constexpr std::ptrdiff_t kMissed = 10;
  const auto second = drive({log.begin() + middle() + kMissed, log.end()});
  end();
  ASSERT_GT(second.size(), 50U);
  for (const ScanPose& pose : second) {
    const Pose2 truth = between(way_.truth(first.front()), way_.truth(pose));
    const Pose2 found = between(pose_of(first.front()), pose_of(pose));
    ASSERT_EQ(pose.run(), 1);
    ASSERT_LT(translation_distance(found, truth), 0.3) << pose.index();
  }
  EXPECT_GE(kept_scans(), kept_before + second.size());
}

// Who restarts it an hour later, or takes the robot for a ride meanwhile, has not reset odometry.
TEST_F(StoredScanMatcher, IsDeadReckonedForHoursWhereTheScanSaysSo) {
  const std::vector<Observation>& log = way_.log;
  const auto half = log.begin() + middle();
  const auto two_thirds = log.begin() + static_cast<std::ptrdiff_t>(2 * log.size() / 3);
  begin();
  const auto first = drive({log.begin(), two_thirds});
  ASSERT_FALSE(first.empty());
  end();
  begin();
  // It drove back while the process was away_.
  constexpr double kHour_s = 3600.0;
  const auto second = drive(by_clock({half, two_thirds}, kHour_s));
  end();
  ASSERT_GT(second.size(), 50U);
  for (const ScanPose& pose : second) {
    ASSERT_EQ(pose.run(), 1);
    const Pose2 truth = between(way_.truth(first.front()), way_.truth(pose, kHour_s));
    const Pose2 found = between(pose_of(first.front()), pose_of(pose));
    ASSERT_LT(translation_distance(found, truth), 0.3) << pose.index();
  }
}

constexpr double kDay_s = 86'400.0;

TEST_F(StoredScanMatcher, BeginsWhereItWasWhenTheOdometryMayHaveBegunAnew) {
  const std::vector<Observation>& log = way_.log;
  const auto first = drive_half();
  ASSERT_FALSE(first.empty());
  begin();
  std::vector<Observation> next_day = by_clock({log.begin() + middle(), log.end()}, kDay_s);
  const Pose2 start = next_day.front().odom_from_robot;
  for (Observation& observation : next_day) {
    observation.odom_from_robot = between(start, observation.odom_from_robot);
  }
  const auto second = drive(next_day);
  ASSERT_FALSE(second.empty());
  EXPECT_EQ(second.front().run(), 1);
  EXPECT_LT(translation_distance(pose_of(second.front()), pose_of(first.back())), 0.2);
  const Pose2 truth = between(way_.truth(first.front()), way_.truth(second.back(), kDay_s));
  EXPECT_LT(translation_distance(between(pose_of(first.front()), pose_of(second.back())), truth),
            0.5);
}

/// A robot that is carried into another building, and in two runs finds no place in its map.
std::vector<std::uint8_t> state_of_unplaced_runs(const Drive& way) {
  slam::Slam slam{slam::SlamConfig{}};
  for (std::size_t i = 0; i < 60; ++i) slam.add(way.log[i]);
  std::vector<Pose2> path;
  for (int i = 0; i < 60; ++i) path.push_back({3.0 + 0.05 * i, 3.0, 0.0});
  for (int run = 1; run < 3; ++run) {
    const auto log = by_clock(test::record(test::room(), path, run, 8), 100.0 * run);
    for (const Observation& observation : log) slam.add(observation);
  }
  return slam.save_state();
}

TEST_F(StoredScanMatcher, SaysThatARunWithoutAPlaceIsForgotten) {
  log::write_state_file(file(), state_of_unplaced_runs(way_));
  MappingRobot::begin("live: {window_scans: 30}, store: {file: '" + file().string() + "'}");
  test::StatusWatch watch(participant_);
  const auto next_day = by_clock({way_.log.begin(), way_.log.begin() + 1}, 86'400.0);
  odometry_.publish(convert::to_odometry(next_day[0].scan.stamp, next_day[0].odom_from_robot,
                                         "odom", "base_link"));
  scans_.publish(convert::to_message(next_day[0].scan, "laser"));
  const auto status = watch.wait_for(*host_, [](const auto& now) {
    return test::value_of(now, "scans forgotten without a place") == "60";
  });
  EXPECT_EQ(test::value_of(status, "scans forgotten without a place"), "60");
  EXPECT_THAT(host_->take_errors(),
              testing::Contains(testing::HasSubstr("ended without a place in the map")));
}

TEST_F(StoredScanMatcher, MapsAnewAndKeepsThatWhenItsFileIsDamaged) {
  std::ofstream(file()) << "not a state";
  begin();
  EXPECT_THAT(host_->take_errors(),
              testing::Contains(testing::HasSubstr(file().string() + ".damaged")));
  ASSERT_FALSE(drive({way_.log.begin(), way_.log.begin() + 20}).empty());
  end();
  EXPECT_EQ(std::filesystem::file_size(file().string() + ".damaged"), 11U);
  EXPECT_GT(kept_scans(), 0U);
}

}  // namespace
}  // namespace strata::scan_matcher
