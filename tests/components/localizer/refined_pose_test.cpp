// SPDX-License-Identifier: Apache-2.0
/// The refined pose of a live localizer: where it goes, and how good it is.
#include <cmath>
#include <cstddef>
#include <string>

#include <gtest/gtest.h>

#include "tests/components/localizer/live_fixture.hpp"

namespace strata::localizer {
namespace {

using Message = geometry_msgs::msg::PoseWithCovarianceStamped;

Pose2 pose_of(const Message& message) {
  return planar(convert::from_message(message.pose().pose()));
}

Pose2 truth_at(const Message& message) {
  const Stamp stamp = convert::from_message(message.header().stamp());
  std::size_t scan = 0;
  while (room().observations[scan].scan.stamp != stamp) ++scan;
  return room().truth.at(scan);
}

class RefinedPose : public LiveLocalizer {
 protected:
  test::Collector<Message> refined_{robot_, "/refined_pose", "default"};

  /// Plays the whole day; how many poses came.
  std::size_t play() {
    std::size_t poses = 0;
    for (; next_scan_ < room().observations.size(); ++poses) (void)next_pose();
    return poses;
  }
};

TEST_F(RefinedPose, IsNearerToTheTruthThanTheFiltersAndSaysHowFar) {
  const std::size_t scans = play();
  const auto refined = refined_.wait_for(scans / 2);
  ASSERT_GE(refined.size(), scans / 2) << "of " << scans;
  double refined_m = 0.0;
  for (const Message& message : refined) {
    EXPECT_EQ(message.header().frame_id(), "map");
    const double off_m = translation_distance(pose_of(message), truth_at(message));
    EXPECT_LT(off_m, 0.05);
    const double stddev_m =
        std::sqrt(message.pose().covariance()[0] + message.pose().covariance()[7]);
    EXPECT_GT(stddev_m, 0.002);
    EXPECT_LT(stddev_m, 0.1);
    refined_m += off_m;
  }
  const auto filtered = poses_.wait_for(scans);
  double filtered_m = 0.0;
  std::size_t compared = 0;
  for (const Message& message : filtered) {
    for (const Message& other : refined) {
      if (!(other.header() == message.header())) continue;
      filtered_m += translation_distance(pose_of(message), truth_at(message));
      ++compared;
    }
  }
  ASSERT_EQ(compared, refined.size());
  EXPECT_LT(refined_m, filtered_m);
  EXPECT_LT(refined_m / static_cast<double>(refined.size()), 0.012);
}

TEST_F(RefinedPose, IsWhatGoesOutWhereTheSettingsSaySo) {
  std::string parameters = parameters_of("filtered", false);
  parameters.pop_back();
  start(parameters + ", pose: refined}");
  const std::size_t scans = play();
  const auto refined = refined_.wait_for(scans / 2);
  ASSERT_GE(refined.size(), scans / 2);
  std::size_t equal = 0;
  for (const Message& message : poses_.wait_for(scans)) {
    for (const Message& other : refined) {
      if (other.header() == message.header()) equal += other == message ? 1 : 0;
    }
  }
  EXPECT_EQ(equal, refined.size());
}

}  // namespace
}  // namespace strata::localizer
