// SPDX-License-Identifier: Apache-2.0
/// Poses over time: TUM, `t x y theta ...`, corrected CARMEN logs, topics of bags.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "components/log/transform_history.hpp"
#include "core/base/time.hpp"
#include "core/geometry/pose2.hpp"

namespace strata::log {

struct StampedPose {
  Stamp stamp;
  Pose2 pose;  ///< of the robot, in whatever frame the file uses
};

struct TrajectoryReport {
  std::size_t unreliable = 0;  ///< rows left out because the file says so
  std::size_t bad_lines = 0;
};

/// Told by content: rows of 8 numbers are TUM (`t x y z qx qy qz qw`, planar part), of 4 or more
/// others `t x y theta ...`; FLASER or ROBOTLASER1 lines are a corrected log, whose laser poses are
/// brought to the robot by the log's mounting; a bag, or BAG:/topic, gives the poses of a topic, as
/// read_pose_topic chooses it. Rows whose last column is named `sd` in the comment
/// above and exceeds 0.3 m are left out and counted. offset_s shifts the stamps. Sorted by stamp.
/// Throws InputError(file:line) for a row that is no pose, and for a file without any.
[[nodiscard]] std::vector<StampedPose> read_trajectory(const std::filesystem::path& path,
                                                       double offset_s = 0.0,
                                                       TrajectoryReport* report = nullptr);

/// The same files with height and full rotation where they are TUM; others lie in the plane.
/// Ready for poses at any moment, interpolated over at most 1 s, as transforms from the frame map
/// to the frame robot. Throws as read_trajectory.
[[nodiscard]] TransformHistory read_space_trajectory(const std::filesystem::path& path,
                                                     const std::string& robot_frame);

/// TUM, one line a pose, 9 decimals; written aside and renamed.
void write_trajectory(const std::filesystem::path& path, std::span<const StampedPose> poses);

}  // namespace strata::log
