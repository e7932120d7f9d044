// SPDX-License-Identifier: Apache-2.0
#include "components/log/trajectory_file.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <string_view>

#include "components/log/bag_pose_topic.hpp"
#include "components/log/carmen.hpp"
#include "components/log/text.hpp"
#include "components/log/whole_file.hpp"
#include "core/base/error.hpp"
#include "core/geometry/angle.hpp"
#include "core/geometry/pose3.hpp"

namespace strata::log {
namespace {

/// Rows that state a standard deviation above this are unreliable [data of Olin: 103 of 357].
constexpr double kLargestDeviationM = 0.3;

std::vector<StampedPose> poses_of_corrected_log(const std::filesystem::path& path) {
  ReadReport report;
  const LogContent content = read_carmen(path, ReadOptions{}, report);
  std::vector<StampedPose> poses;
  for (const Observation& observation : content.observations) {
    const Scan& scan = observation.scan;
    poses.push_back({scan.stamp, observation.odom_from_robot});
  }
  return poses;
}

/// A log over raw odometry keeps the corrected pose in the laser fields only.
std::vector<StampedPose> laser_poses(const std::filesystem::path& path) {
  LineReader lines(path);
  std::string line;
  std::vector<std::string_view> words;
  std::vector<StampedPose> poses;
  ReadReport report;
  const LogContent content = read_carmen(path, ReadOptions{}, report);
  const Pose2 laser_from_robot = inverse(content.observations.front().scan.robot_from_laser);
  while (lines.next(line)) {
    split(line, words);
    if (words.size() < 10 || words[0] != "FLASER") continue;
    const auto beams = parse_integer(words[1]);
    if (!beams || *beams < 0 || words.size() < static_cast<std::size_t>(*beams) + 9) continue;
    const auto at = [&](std::size_t field) {
      return words[static_cast<std::size_t>(*beams) + 2 + field];
    };
    const auto x = parse_double(at(0));
    const auto y = parse_double(at(1));
    const auto theta = parse_double(at(2));
    const auto stamp = parse_stamp(at(6));
    if (x && y && theta && stamp) {
      poses.push_back({*stamp, Pose2{*x, *y, wrap_angle(*theta)} * laser_from_robot});
    }
  }
  // ROBOTLASER1 alone: its robot pose is the corrected one.
  return poses.empty() ? poses_of_corrected_log(path) : poses;
}

std::optional<StampedPose> parse_row(const std::vector<std::string_view>& words) {
  if (words.size() < 4) return std::nullopt;
  const auto stamp = parse_stamp(words[0]);
  double values[7] = {};
  const bool tum = words.size() == 8;
  for (std::size_t i = 1; i < (tum ? 8U : 4U); ++i) {
    const auto value = parse_double(words[i]);
    if (!value || !std::isfinite(*value)) return std::nullopt;
    values[i - 1] = *value;
  }
  if (!stamp) return std::nullopt;
  StampedPose row{*stamp, {values[0], values[1], 0.0}};
  if (tum) {
    const Eigen::Quaterniond rotation(values[6], values[3], values[4], values[5]);
    if (rotation.norm() < 0.5) return std::nullopt;
    row.pose.theta = heading_of(rotation.normalized());
  } else {
    row.pose.theta = wrap_angle(values[2]);
  }
  return row;
}

void shift_and_sort(std::vector<StampedPose>& poses, double offset_s) {
  for (StampedPose& pose : poses) pose.stamp = pose.stamp + Duration::from_seconds(offset_s);
  std::stable_sort(poses.begin(), poses.end(),
                   [](const auto& a, const auto& b) { return a.stamp < b.stamp; });
}

std::vector<StampedPose> poses_of_bag(const std::filesystem::path& path, double offset_s,
                                      TrajectoryReport& report) {
  const PoseTopic topic = read_pose_topic(path);
  report.bad_lines = topic.unreadable;
  std::vector<StampedPose> poses;
  for (const SpacePose& row : topic.poses) poses.push_back({row.stamp, planar(row.pose)});
  shift_and_sort(poses, offset_s);
  return poses;
}

}  // namespace

std::vector<StampedPose> read_trajectory(const std::filesystem::path& path, double offset_s,
                                         TrajectoryReport* report) {
  TrajectoryReport own;
  TrajectoryReport& used = report != nullptr ? *report : own;
  used = TrajectoryReport{};
  if (names_pose_topic(path)) return poses_of_bag(path, offset_s, used);
  std::vector<StampedPose> poses;
  LineReader lines(path);
  std::string line;
  std::vector<std::string_view> words;
  bool states_deviation = false;
  while (lines.next(line)) {
    split(line, words);
    if (words.empty()) continue;
    if (words[0].front() == '#') {
      states_deviation = words.back() == "sd";
      continue;
    }
    if (words[0] == "FLASER" || words[0] == "ROBOTLASER1" || words[0] == "PARAM" ||
        words[0] == "ODOM") {
      poses = laser_poses(path);
      break;
    }
    const auto row = parse_row(words);
    if (!row) {
      throw InputError(lines.place(), "is not a pose",
                       "rows are `t x y theta` or TUM `t x y z qx qy qz qw`");
    }
    const auto deviation = states_deviation ? parse_double(words.back()) : std::nullopt;
    if (deviation && !(*deviation <= kLargestDeviationM)) {
      ++used.unreliable;
      continue;
    }
    poses.push_back(*row);
  }
  if (!lines.damage().empty()) throw lines.damage_error();
  if (poses.empty()) {
    throw InputError(path.string(), "holds no usable pose",
                     "give TUM, `t x y theta` rows, a corrected CARMEN log or a bag with poses");
  }
  shift_and_sort(poses, offset_s);
  return poses;
}

TransformHistory read_space_trajectory(const std::filesystem::path& path,
                                       const std::string& robot_frame) {
  TransformHistory history;
  if (names_pose_topic(path)) {
    for (const SpacePose& row : read_pose_topic(path).poses) {
      history.add("map", robot_frame, row.stamp, row.pose);
    }
    return history;
  }
  // Checks every row, and reads what has no height.
  const std::vector<StampedPose> planar_poses = read_trajectory(path);
  LineReader lines(path);
  std::string line;
  std::vector<std::string_view> words;
  bool is_tum = false;
  while (lines.next(line)) {
    split(line, words);
    if (words.empty() || words[0].front() == '#') continue;
    if (words.size() != 8) break;
    double v[7] = {};
    for (std::size_t i = 0; i < 7; ++i) v[i] = parse_double(words[i + 1]).value_or(0.0);
    Pose3 pose;
    pose.translation = {v[0], v[1], v[2]};
    pose.rotation = Eigen::Quaterniond(v[6], v[3], v[4], v[5]).normalized();
    history.add("map", robot_frame, *parse_stamp(words[0]), pose);
    is_tum = true;
  }
  if (!is_tum) {
    for (const StampedPose& row : planar_poses) {
      history.add("map", robot_frame, row.stamp, lift(row.pose));
    }
  }
  return history;
}

void write_trajectory(const std::filesystem::path& path, std::span<const StampedPose> poses) {
  WholeFile file(path);
  for (const StampedPose& row : poses) {
    char text[256];
    std::snprintf(text, sizeof text, " %.9f %.9f 0 0 0 %.12f %.12f\n", row.pose.x, row.pose.y,
                  std::sin(row.pose.theta / 2.0), std::cos(row.pose.theta / 2.0));
    file.stream() << format_stamp(row.stamp) << text;
  }
  file.commit();
}

}  // namespace strata::log
