// SPDX-License-Identifier: Apache-2.0
#include "tools/simulate/robot.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/angle.hpp"
#include "core/random/stream.hpp"

namespace strata::simulate {
namespace {

Eigen::Vector2d waypoint(const RobotConfig& config, std::size_t i) {
  return {config.route[2 * i], config.route[2 * i + 1]};
}

/// The robot after `distance_m` along an arc that turns it by `turn_rad`.
Pose2 along_arc(const Pose2& pose, double distance_m, double turn_rad) {
  // Straight along the middle heading: exact to third order in the turn of one step.
  const double heading = pose.theta + 0.5 * turn_rad;
  return {pose.x + distance_m * std::cos(heading), pose.y + distance_m * std::sin(heading),
          wrap_angle(pose.theta + turn_rad)};
}

}  // namespace

Pose2 first_pose(const RobotConfig& config) {
  const Eigen::Vector2d from = waypoint(config, 0);
  const Eigen::Vector2d to = config.route.size() >= 4 ? waypoint(config, 1) : from;
  return {from.x(), from.y(), std::atan2(to.y() - from.y(), to.x() - from.x())};
}

std::vector<Pose2> drive(const RobotConfig& config, const Pose2& start) {
  constexpr double kTurnGain = 3.0;
  constexpr double kGiveUp_s = 120.0;
  const std::size_t waypoints = config.route.size() / 2;
  std::vector<Pose2> poses{start};
  for (std::size_t i = 0; i < waypoints * static_cast<std::size_t>(config.laps); ++i) {
    const Eigen::Vector2d target = waypoint(config, i % waypoints);
    for (double spent_s = 0.0; spent_s < kGiveUp_s; spent_s += kDriveStep_s) {
      const Pose2& pose = poses.back();
      const Eigen::Vector2d to = target - pose.translation();
      if (to.norm() < config.reach_m) break;
      const double error = wrap_angle(std::atan2(to.y(), to.x()) - pose.theta);
      const double turn_rate =
          std::clamp(kTurnGain * error, -config.turn_rate_rps, config.turn_rate_rps);
      // On the spot until it faces the waypoint, so that it does not swing into walls.
      const double speed = config.speed_mps * std::max(0.0, 1.0 - std::abs(error) / 0.6);
      poses.push_back(along_arc(pose, speed * kDriveStep_s, turn_rate * kDriveStep_s));
    }
  }
  return poses;
}

std::vector<Pose2> odometry(const RobotConfig& config, const std::vector<Pose2>& true_poses,
                            const Pose2& start, std::uint64_t seed, int day) {
  RandomStream random(seed, StreamId::kSimulatorOdometry, static_cast<std::uint64_t>(day));
  const double scale = 1.0 + config.scale_stddev * random.normal();
  const double turn_scale = 1.0 + config.turn_scale_stddev * random.normal();
  std::vector<Pose2> poses{start};
  poses.reserve(true_poses.size());
  for (std::size_t i = 1; i < true_poses.size(); ++i) {
    const double distance = translation_distance(true_poses[i - 1], true_poses[i]);
    const double turn = angle_difference(true_poses[i].theta, true_poses[i - 1].theta);
    const double turn_stddev =
        std::sqrt(config.rot_noise * config.rot_noise * std::abs(turn) +
                  config.drift_rad_per_sqrt_m * config.drift_rad_per_sqrt_m * distance);
    const double noisy_distance =
        scale * distance + config.trans_noise * std::sqrt(distance) * random.normal();
    const double noisy_turn = turn_scale * turn + turn_stddev * random.normal();
    poses.push_back(along_arc(poses.back(), noisy_distance, noisy_turn));
  }
  return poses;
}

}  // namespace strata::simulate
