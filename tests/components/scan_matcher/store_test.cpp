// SPDX-License-Identifier: Apache-2.0
/// A scan matcher whose process ends and begins again.
#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/convert/geometry_messages.hpp"
#include "components/convert/scan_messages.hpp"
#include "components/log/state_store.hpp"
#include "components/scan_matcher/register.hpp"
#include "core/base/error.hpp"
#include "core/slam/slam.hpp"
#include "tests/components/runtime/host_fixture.hpp"
#include "tests/components/runtime/status_watch.hpp"
#include "tests/core/slam/ring_world.hpp"
#include "tests/support/test_data.hpp"

namespace strata::scan_matcher {
namespace {

using strata_msgs::msg::ScanPose;

/// The robot's sensors, and a mapping process that can be ended and begun again.
class StoredScanMatcher : public ::testing::Test {
 protected:
  StoredScanMatcher()
      : participant_(test::make_participant()),
        scans_(participant_, "/scan", bus::qos_profile("lossless")),
        odometry_(participant_, "/odom", bus::qos_profile("lossless")),
        tf_static_(participant_, "/tf_static", bus::qos_profile("tf_static")) {
    tf2_msgs::msg::TFMessage mounting;
    mounting.transforms().push_back(
        convert::to_transform_stamped({}, Pose2{}, "base_link", "laser"));
    tf_static_.publish(mounting);
    register_component(registry_);
  }
  [[nodiscard]] std::filesystem::path file() const { return folder_.path() / "slam.state"; }

  void begin() {
    poses_ = std::make_unique<test::Collector<ScanPose>>(participant_, "/scan_pose", "lossless");
    host_ = test::make_host(
        "{type: strata::ScanMatcher, name: slam, parameters: {sensor_qos: lossless, store: {file: "
        "'" +
            file().string() + "', period_s: 1}}}",
        registry_, test::make_participant());
    host_->activate();
    EXPECT_TRUE(scans_.raw().wait_for_readers(1, std::chrono::seconds(20)));
    hear_odometry();
  }
  /// A replay is short, and what is published before the reader knows its writer is lost.
  void hear_odometry() {
    test::StatusWatch watch(participant_);
    const auto status = watch.wait_for(*host_, [&](const auto& now) {
      odometry_.publish(convert::to_odometry(Stamp{1}, Pose2{}, "odom", "base_link"));
      const std::string received = test::value_of(now, "received /odom");
      return !received.empty() && received != "0";
    });
    EXPECT_NE(test::value_of(status, "received /odom"), "");
  }
  /// The poses that were told of the scans, when the last one's has come.
  std::vector<ScanPose> drive(const std::vector<Observation>& log) {
    for (const Observation& observation : log) {
      odometry_.publish(convert::to_odometry(observation.scan.stamp, observation.odom_from_robot,
                                             "odom", "base_link"));
      scans_.publish(convert::to_message(observation.scan, "laser"));
    }
    std::vector<ScanPose> told = poses_->wait_for(1);
    const auto is_last = [&](const ScanPose& pose) {
      return convert::from_message(pose.header().stamp()) == log.back().scan.stamp;
    };
    while (!told.empty() && !is_last(told.back())) {
      std::vector<ScanPose> more = poses_->wait_for(told.size() + 1);
      if (more.size() == told.size()) break;
      told = std::move(more);
    }
    return told;
  }
  void end() { host_.reset(); }
  [[nodiscard]] std::size_t kept_scans() const {
    slam::Slam slam{slam::SlamConfig{}};
    slam.restore_state(log::read_state_file(file()), file().string());
    return slam.kept_scans();
  }

  test::TemporaryDirectory folder_;
  std::shared_ptr<bus::Participant> participant_;
  std::unique_ptr<test::Collector<ScanPose>> poses_;
  bus::Writer<sensor_msgs::msg::LaserScan> scans_;
  bus::Writer<nav_msgs::msg::Odometry> odometry_;
  bus::Writer<tf2_msgs::msg::TFMessage> tf_static_;
  runtime::Registry registry_;
  std::unique_ptr<runtime::Host> host_;
};

Pose2 pose_of(const ScanPose& message) {
  return convert::from_message(message.map_from_robot().mean());
}

/// Most of the way round the block, and what was recorded.
struct Drive {
  std::vector<Pose2> path = test::drive_round(0.1, 30.0);
  std::vector<Observation> log = test::record(test::ring(), path, 0, 5);

  /// Where the robot was at that scan.
  [[nodiscard]] Pose2 truth(const ScanPose& message, double later_s = 0.0) const {
    const double since_s = convert::from_message(message.header().stamp()).seconds() - later_s;
    return path.at(static_cast<std::size_t>(since_s / 0.2 + 0.5));
  }
};

TEST_F(StoredScanMatcher, GoesOnInItsMapWithTheOdometryThatWentOn) {
  const Drive way;
  const std::vector<Observation>& log = way.log;
  const std::size_t half = log.size() / 2;
  begin();
  const auto first = drive({log.begin(), log.begin() + static_cast<std::ptrdiff_t>(half)});
  ASSERT_FALSE(first.empty());
  end();
  const std::size_t kept_before = kept_scans();
  EXPECT_GT(kept_before, 0U);
  begin();
  // Some scans were missed while it was away.
  constexpr std::size_t kMissed = 10;
  const auto second = drive({log.begin() + static_cast<std::ptrdiff_t>(half + kMissed), log.end()});
  end();
  ASSERT_GT(second.size(), 50U);
  for (const ScanPose& pose : second) {
    const Pose2 truth = between(way.truth(first.front()), way.truth(pose));
    const Pose2 found = between(pose_of(first.front()), pose_of(pose));
    ASSERT_EQ(pose.run(), 0);
    ASSERT_LT(translation_distance(found, truth), 0.3) << pose.index();
  }
  EXPECT_GE(kept_scans(), kept_before + second.size());
}

constexpr double kDay_s = 86'400.0;

TEST_F(StoredScanMatcher, BeginsWhereItWasWhenTheOdometryMayHaveBegunAnew) {
  const Drive way;
  const std::vector<Observation>& log = way.log;
  const std::size_t half = log.size() / 2;
  begin();
  const auto first = drive({log.begin(), log.begin() + static_cast<std::ptrdiff_t>(half)});
  ASSERT_FALSE(first.empty());
  end();
  begin();
  std::vector<Observation> next_day{log.begin() + static_cast<std::ptrdiff_t>(half), log.end()};
  const Pose2 start = next_day.front().odom_from_robot;
  for (Observation& observation : next_day) {
    observation.scan.stamp = observation.scan.stamp + Duration::from_seconds(kDay_s);
    observation.odom_from_robot = between(start, observation.odom_from_robot);
  }
  const auto second = drive(next_day);
  ASSERT_FALSE(second.empty());
  EXPECT_EQ(second.front().run(), 1);
  EXPECT_LT(translation_distance(pose_of(second.front()), pose_of(first.back())), 0.2);
  const Pose2 truth = between(way.truth(first.front()), way.truth(second.back(), kDay_s));
  EXPECT_LT(translation_distance(between(pose_of(first.front()), pose_of(second.back())), truth),
            0.5);
}

TEST_F(StoredScanMatcher, RefusesADamagedFileAndLeavesItAsItIs) {
  std::ofstream(file()) << "not a state";
  try {
    begin();
    FAIL() << "it began";
  } catch (const InputError& error) {
    EXPECT_EQ(error.place(), file().string());
    EXPECT_THAT(error.what(), testing::HasSubstr("is damaged"));
  }
  EXPECT_EQ(std::filesystem::file_size(file()), 11U);
}

}  // namespace
}  // namespace strata::scan_matcher
