// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/runs_input.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <utility>

#include "components/log/ros_stamps.hpp"
#include "core/base/error.hpp"

namespace strata::pipeline {
namespace {

constexpr std::int64_t kSameStamp_ns = 1'000'000;
constexpr double kLongestGap_s = 1.0;
constexpr double kLargestBuilding_m = 1e5;
constexpr double kFarOrigin_m = 1e7;

void require_one_a_log(const std::vector<std::string>& files, std::size_t logs,
                       const char* option) {
  if (files.empty() || files.size() == logs) return;
  throw InputError(
      option,
      "is given " + std::to_string(files.size()) + " times for " + std::to_string(logs) + " logs",
      "give it once per log, in the order of the logs");
}

void require_near(const Pose2& pose, const std::string& file, const char* option) {
  if (std::hypot(pose.x, pose.y) <= kFarOrigin_m) return;
  throw InputError(file, "has poses more than 10,000 km from the origin",
                   std::string("give ") + option + " in metres, in a frame near the building");
}

void append_poses(const std::vector<std::string>& files, std::size_t log, double offset_s,
                  std::span<const Observation> observations,
                  std::vector<std::optional<Pose2>>& poses, const char* option) {
  if (files.empty()) {
    poses.resize(poses.size() + observations.size());
    return;
  }
  const auto trajectory = log::read_trajectory(files[log], offset_s);
  std::size_t found = 0;
  for (const Observation& observation : observations) {
    poses.push_back(pose_at(trajectory, observation.scan.stamp));
    found += poses.back() ? 1 : 0;
    if (poses.back()) require_near(*poses.back(), files[log], option);
  }
  if (found == 0) {
    throw InputError(files[log], "has no pose at the time of any scan",
                     "check that it belongs to this log, or shift it with --truth-offset");
  }
}

}  // namespace

void bring_near(std::vector<Observation>& run, const std::string& log, log::ReadReport& report) {
  if (run.empty() || !run.front().has_odometry) return;
  const Pose2 begin = run.front().odom_from_robot;
  for (std::size_t i = 0; i < run.size(); ++i) {
    const Pose2& pose = run[i].odom_from_robot;
    if (std::hypot(pose.x - begin.x, pose.y - begin.y) <= kLargestBuilding_m) continue;
    throw InputError(log + ": scan " + std::to_string(i + 1),
                     "its odometry is more than 100 km from that of the first scan",
                     "mend the log, cut it with --from and --to, or leave odometry out with "
                     "--no-odometry");
  }
  if (std::hypot(begin.x, begin.y) <= kFarOrigin_m) return;
  for (Observation& observation : run) {
    observation.odom_from_robot.x -= begin.x;
    observation.odom_from_robot.y -= begin.y;
  }
  report.warnings.push_back(
      "odometry begins more than 10,000 km from its origin: positions are taken from the first "
      "scan's");
}

std::optional<Pose2> pose_at(std::span<const log::StampedPose> trajectory, Stamp stamp) {
  const auto after = std::lower_bound(
      trajectory.begin(), trajectory.end(), stamp,
      [](const log::StampedPose& pose, Stamp value) { return pose.stamp < value; });
  if (after != trajectory.end() && (after->stamp - stamp).ns <= kSameStamp_ns) return after->pose;
  if (after == trajectory.begin()) return std::nullopt;
  const auto before = after - 1;
  if ((stamp - before->stamp).ns <= kSameStamp_ns) return before->pose;
  if (after == trajectory.end()) return std::nullopt;
  const double gap_s = (after->stamp - before->stamp).seconds();
  if (gap_s > kLongestGap_s) return std::nullopt;
  return interpolate(before->pose, after->pose, (stamp - before->stamp).seconds() / gap_s);
}

Runs read_runs(const RunsInput& input, Progress* progress, int first_run) {
  require_one_a_log(input.poses, input.logs.size(), "--poses");
  require_one_a_log(input.truths, input.logs.size(), "--truth");
  require_valid(input.cloud, "--min-height, --max-height");
  Runs runs;
  for (std::size_t i = 0; i < input.logs.size(); ++i) {
    log::ReadOptions options;
    options.run = first_run + static_cast<int>(i);
    options.from_s = input.from_s;
    options.to_s = input.to_s;
    options.use_odometry = input.use_odometry;
    options.scan_topics = input.scan_topics;
    options.cloud = input.cloud;
    options.max_range_m = input.max_range_m;
    options.odometry_lag_s = input.odometry_lag_s;
    options.progress = progress;
    log::ReadReport report;
    std::vector<Observation> run = log::read_observations(input.logs[i], options, &report);
    bring_near(run, input.logs[i], report);
    if (input.needs_ros_stamps) log::require_ros_stamps(run, {}, input.logs[i]);
    append_poses(input.poses, i, 0.0, run, runs.poses, "--poses");
    append_poses(input.truths, i, input.truth_offset_s, run, runs.truths, "--truth");
    runs.reports.push_back(std::move(report));
    for (Observation& observation : run) runs.observations.push_back(std::move(observation));
  }
  return runs;
}

std::vector<double> elapsed_seconds(std::span<const Observation> observations) {
  std::vector<double> elapsed(observations.size(), 0.0);
  for (std::size_t i = 1; i < observations.size(); ++i) {
    const Observation& now = observations[i];
    const Observation& before = observations[i - 1];
    const double step_s =
        now.run == before.run ? (now.scan.stamp - before.scan.stamp).seconds() : 0.0;
    elapsed[i] = elapsed[i - 1] + step_s;
  }
  return elapsed;
}

}  // namespace strata::pipeline
