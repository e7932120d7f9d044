// SPDX-License-Identifier: Apache-2.0
/// The poses that a bag tells of the robot, as of a motion capture system: its truth.
#pragma once

#include <filesystem>
#include <vector>

#include "core/base/time.hpp"
#include "core/geometry/pose3.hpp"

namespace strata::log {

struct SpacePose {
  Stamp stamp;  ///< of the message's header
  Pose3 pose;   ///< in whatever frame the topic uses
};
struct PoseTopic {
  std::vector<SpacePose> poses;  ///< in the order of recording
  std::size_t unreadable = 0;    ///< messages left out: damaged, or not finite
};

/// Whether the path is one for read_pose_topic: a bag, or BAG:/topic.
[[nodiscard]] bool names_pose_topic(const std::filesystem::path& path);

/// BAG alone: of geometry_msgs/PoseStamped, from /ground_truth or its only topic of that type.
/// BAG:/topic: of that topic, which may also be of PoseWithCovarianceStamped or nav_msgs/Odometry.
/// Throws InputError when there is none, or several and none is named. Reads the whole bag.
[[nodiscard]] PoseTopic read_pose_topic(const std::filesystem::path& path);

}  // namespace strata::log
