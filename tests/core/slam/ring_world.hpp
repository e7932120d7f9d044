// SPDX-License-Identifier: Apache-2.0
/// A corridor round a block, drives along it and what a robot records there.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "core/geometry/angle.hpp"
#include "core/random/stream.hpp"
#include "core/slam/slam.hpp"
#include "tests/core/registration/room_world.hpp"

namespace strata::test {

/// A corridor once round a block of 10 m x 6 m, 2 m wide, with niches that tell its sides apart.
inline std::vector<Wall> ring() {
  std::vector<Wall> walls{{0.0, 0.0, 14.0, 0.0}, {14.0, 0.0, 14.0, 10.0}, {14.0, 10.0, 0.0, 10.0},
                          {0.0, 10.0, 0.0, 0.0}, {2.0, 2.0, 12.0, 2.0},   {12.0, 2.0, 12.0, 8.0},
                          {12.0, 8.0, 2.0, 8.0}, {2.0, 8.0, 2.0, 2.0}};
  const auto box = [&walls](double x, double y, double w, double h) {
    walls.push_back({x, y, x + w, y});
    walls.push_back({x + w, y, x + w, y + h});
    walls.push_back({x + w, y + h, x, y + h});
    walls.push_back({x, y + h, x, y});
  };
  box(3.0, 0.0, 0.5, 0.3);
  box(7.0, 1.7, 0.8, 0.3);
  box(10.0, 0.0, 0.3, 0.4);
  box(13.6, 3.0, 0.4, 0.7);
  box(12.0, 6.0, 0.3, 0.5);
  box(9.0, 9.7, 1.0, 0.3);
  box(5.0, 8.0, 0.4, 0.3);
  box(0.0, 7.0, 0.3, 0.6);
  box(1.7, 4.0, 0.3, 0.9);
  return walls;
}

/// Poses every `step_m` along the middle of the ring, turning on the spot at the corners.
inline std::vector<Pose2> drive_round(double step_m, double metres) {
  const double corners[4][2] = {{1.0, 1.0}, {13.0, 1.0}, {13.0, 9.0}, {1.0, 9.0}};
  std::vector<Pose2> poses;
  double left = metres;
  Pose2 pose{1.0, 1.0, 0.0};
  for (int side = 0; left > 0.0; ++side) {
    const double* to = corners[(side + 1) % 4];
    const double heading = wrap_angle(side * std::numbers::pi / 2.0);
    while (std::abs(angle_difference(heading, pose.theta)) > 1e-9) {
      const double turn = angle_difference(heading, pose.theta);
      pose.theta = wrap_angle(pose.theta + std::clamp(turn, -0.15, 0.15));
      poses.push_back(pose);
    }
    double to_go = std::hypot(to[0] - pose.x, to[1] - pose.y);
    while (to_go > 1e-9 && left > 0.0) {
      const double step = std::min(step_m, to_go);
      pose = pose * Pose2{step, 0.0, 0.0};
      pose.theta = heading;
      poses.push_back(pose);
      to_go -= step;
      left -= step;
    }
  }
  return poses;
}

/// What a robot on that path records, with odometry that drifts in heading and scale.
inline std::vector<Observation> record(const std::vector<Wall>& walls,
                                       const std::vector<Pose2>& path, int run,
                                       std::uint64_t seed) {
  std::vector<Observation> log;
  RandomStream random(seed, StreamId::kTest, 99);
  Pose2 odom = path.front();
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (i > 0) {
      Pose2 step = between(path[i - 1], path[i]);
      step.x = step.x * 1.03 + random.normal(0.0, 0.003);
      step.theta += 0.004 * std::hypot(step.x, step.y) / 0.1 + random.normal(0.0, 0.003);
      odom = odom * step;
    }
    Observation observation;
    observation.run = run;
    observation.scan = scan_of(walls, path[i], 0.2 * static_cast<double>(i), 0.01, seed);
    observation.odom_from_robot = odom;
    log.push_back(std::move(observation));
  }
  return log;
}

/// As a scanner of so many beams all round sees it.
inline std::vector<Observation> record_with(int beams, const std::vector<Wall>& walls,
                                            const std::vector<Pose2>& path, double noise_m = 0.01) {
  std::vector<Observation> log = record(walls, path, 0, 43);
  for (std::size_t i = 0; i < path.size(); ++i) {
    log[i].scan = scan_of(walls, path[i], 0.2 * static_cast<double>(i), noise_m, 43, beams,
                          2.0 * std::numbers::pi);
  }
  return log;
}

/// After one rigid alignment.
inline double worst_error(const slam::SlamResult& result, const std::vector<Pose2>& truth,
                          int run) {
  std::vector<Pose2> found;
  for (const PosedScan& scan : result.scans) {
    if (scan.run == run) found.push_back(scan.map_from_robot);
  }
  // The map hangs on the first scan alone, whose heading error would count at every other one.
  const Pose2 truth_from_map = align(found, truth);
  double worst = 0.0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    worst = std::max(worst, translation_distance(truth_from_map * found[i], truth[i]));
  }
  return worst;
}

inline slam::SlamResult run_slam(const std::vector<Observation>& log, int threads = 1,
                                 const slam::SlamConfig& config = {}) {
  slam::Slam slam(config, threads);
  for (const Observation& observation : log) slam.add(observation);
  return slam.finish();
}

}  // namespace strata::test
