// SPDX-License-Identifier: Apache-2.0
/// One or several logs with the poses and ground truth that come with them.
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "components/log/log_reader.hpp"
#include "components/log/trajectory_file.hpp"
#include "core/base/progress.hpp"
#include "core/scan/scan.hpp"

namespace strata::pipeline {

/// Files of a job; poses and truths are empty or one a log, in order.
struct RunsInput {
  std::vector<std::string> logs;
  std::vector<std::string> poses;
  std::vector<std::string> truths;
  double from_s = 0.0;
  double to_s = std::numeric_limits<double>::infinity();
  double truth_offset_s = 0.0;
  bool use_odometry = true;
  /// Topics of the robot's scanners in bags; empty: the only one, or /scan.
  std::vector<std::string> scan_topics;
  bool needs_ros_stamps = false;         ///< the scans are to become messages
  CloudSliceConfig cloud;                ///< how scans are made of those with point clouds
  double max_range_m = 0.0;              ///< log::ReadOptions
  std::optional<double> odometry_lag_s;  ///< log::ReadOptions
};

/// Observations of all runs one after the other; poses and truths have one entry an observation.
struct Runs {
  std::vector<Observation> observations;
  std::vector<std::optional<Pose2>> poses;
  std::vector<std::optional<Pose2>> truths;
  std::vector<log::ReadReport> reports;
};

/// Reads everything; run ids count from first_run. Throws InputError, also when the number of pose
/// or truth files does not fit the logs.
[[nodiscard]] Runs read_runs(const RunsInput& input, Progress* progress, int first_run = 0);

/// Cells of maps count from the origin: odometry that begins more than 10,000 km from it is moved
/// there, so that it begins with 0, 0, and the report says so. Localizing and matching need only
/// the differences. log: its name. Throws InputError where it leads more than 100 km away from its
/// begin, which no building is large enough for.
void bring_near(std::vector<Observation>& run, const std::string& log, log::ReadReport& report);

/// The pose at a stamp: an entry within 1 ms, else between two entries at most 1 s apart; nothing
/// outside. Requires stamps in order. O(log n).
[[nodiscard]] std::optional<Pose2> pose_at(std::span<const log::StampedPose> trajectory,
                                           Stamp stamp);

/// Seconds from the first scan, runs appended without gaps between them. Requires Runs' order.
[[nodiscard]] std::vector<double> elapsed_seconds(std::span<const Observation> observations);

}  // namespace strata::pipeline
