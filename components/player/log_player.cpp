// SPDX-License-Identifier: Apache-2.0
#include "components/player/log_player.hpp"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "components/convert/geometry_messages.hpp"
#include "components/convert/scan_messages.hpp"

namespace strata::player {
namespace {

constexpr const char* kMap = "map";

/// More frames than a robot has scanners: then it is the mounting of one that changes.
constexpr std::size_t kMaxFrames = 16;

tf2_msgs::msg::TFMessage single(const geometry_msgs::msg::TransformStamped& transform) {
  tf2_msgs::msg::TFMessage message;
  message.transforms().push_back(transform);
  return message;
}

}  // namespace

LogPlayer::LogPlayer(std::vector<Observation> observations, Outputs outputs,
                     std::vector<std::optional<Pose2>> given_poses, FrameNames frames)
    : observations_(std::move(observations)),
      outputs_(std::move(outputs)),
      given_poses_(std::move(given_poses)),
      frames_(std::move(frames)) {}

std::string LogPlayer::frame_of(const Scan& scan) {
  const auto place = std::find(mountings_.begin(), mountings_.end(), scan.robot_from_laser);
  const auto number = static_cast<std::size_t>(place - mountings_.begin());
  const auto name = [this](std::size_t i) {
    return i == 0 ? frames_.laser : frames_.laser + "_" + std::to_string(i);
  };
  if (place != mountings_.end()) return name(number);
  if (mountings_.size() >= kMaxFrames) mountings_.clear();
  mountings_.push_back(scan.robot_from_laser);
  tf2_msgs::msg::TFMessage all;
  for (std::size_t i = 0; i < mountings_.size(); ++i) {
    all.transforms().push_back(
        convert::to_transform_stamped(scan.stamp, mountings_[i], frames_.robot, name(i)));
  }
  outputs_.tf_static(all);
  return name(mountings_.size() - 1);
}

void LogPlayer::publish(std::size_t index) {
  const Observation& observation = observations_[index];
  const Scan& scan = observation.scan;
  rosgraph_msgs::msg::Clock clock;
  clock.clock(convert::to_message(scan.stamp));
  outputs_.clock(clock);
  const std::string frame = frame_of(scan);
  if (observation.has_odometry) {
    const Pose2& odom_from_robot = observation.odom_from_robot;
    outputs_.tf(single(convert::to_transform_stamped(scan.stamp, odom_from_robot, frames_.odometry,
                                                     frames_.robot)));
    outputs_.odometry(
        convert::to_odometry(scan.stamp, odom_from_robot, frames_.odometry, frames_.robot));
  }
  if (outputs_.given_pose) {
    constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
    const bool known = index < given_poses_.size() && given_poses_[index].has_value();
    strata_msgs::msg::ScanPose given;
    given.header(convert::make_header(scan.stamp, kMap));
    given.run(observation.run);
    given.index(index);
    given.map_from_robot().mean(
        convert::to_message(known ? *given_poses_[index] : Pose2{kUnknown, kUnknown, kUnknown}));
    outputs_.given_pose(given);
  }
  outputs_.scan(convert::to_message(scan, frame));
}

}  // namespace strata::player
