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

auto at_mounting(const std::vector<log::ScannerFrame>& frames, const Pose2& robot_from_laser) {
  return std::find_if(frames.begin(), frames.end(), [&](const log::ScannerFrame& frame) {
    return frame.robot_from_laser == robot_from_laser;
  });
}

}  // namespace

LogPlayer::LogPlayer(std::vector<Observation> observations, Outputs outputs,
                     std::vector<std::optional<Pose2>> given_poses, FrameNames frames)
    : observations_(std::move(observations)),
      outputs_(std::move(outputs)),
      given_poses_(std::move(given_poses)),
      frames_(std::move(frames)) {}

std::string LogPlayer::name_of(const Pose2& mounting) const {
  const auto known = at_mounting(frames_.scanners, mounting);
  if (known != frames_.scanners.end()) return known->name;
  return seen_.empty() ? frames_.laser : frames_.laser + "_" + std::to_string(seen_.size());
}

std::string LogPlayer::frame_of(const Scan& scan) {
  const auto seen = at_mounting(seen_, scan.robot_from_laser);
  if (seen != seen_.end()) return seen->name;
  if (seen_.size() >= kMaxFrames) seen_.clear();
  seen_.push_back({scan.robot_from_laser, name_of(scan.robot_from_laser)});
  tf2_msgs::msg::TFMessage all;
  for (const log::ScannerFrame& frame : seen_) {
    all.transforms().push_back(convert::to_transform_stamped(scan.stamp, frame.robot_from_laser,
                                                             frames_.robot, frame.name));
  }
  outputs_.tf_static(all);
  return seen_.back().name;
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
