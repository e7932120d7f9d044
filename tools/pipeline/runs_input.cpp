// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/runs_input.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <utility>

#include "core/base/error.hpp"

namespace strata::pipeline {
namespace {

constexpr std::int64_t kSameStamp_ns = 1'000'000;
constexpr double kLongestGap_s = 1.0;

void require_one_a_log(const std::vector<std::string>& files, std::size_t logs,
                       const char* option) {
  if (files.empty() || files.size() == logs) return;
  throw InputError(
      option,
      "is given " + std::to_string(files.size()) + " times for " + std::to_string(logs) + " logs",
      "give it once per log, in the order of the logs");
}

void append_poses(const std::vector<std::string>& files, std::size_t log, double offset_s,
                  std::span<const Observation> observations,
                  std::vector<std::optional<Pose2>>& poses) {
  if (files.empty()) {
    poses.resize(poses.size() + observations.size());
    return;
  }
  const auto trajectory = log::read_trajectory(files[log], offset_s);
  std::size_t found = 0;
  for (const Observation& observation : observations) {
    poses.push_back(pose_at(trajectory, observation.scan.stamp));
    found += poses.back() ? 1 : 0;
  }
  if (found == 0) {
    throw InputError(files[log], "has no pose at the time of any scan",
                     "check that it belongs to this log, or shift it with --truth-offset");
  }
}

}  // namespace

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
    options.progress = progress;
    log::ReadReport report;
    std::vector<Observation> run = log::read_observations(input.logs[i], options, &report);
    append_poses(input.poses, i, 0.0, run, runs.poses);
    append_poses(input.truths, i, input.truth_offset_s, run, runs.truths);
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
