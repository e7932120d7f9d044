// SPDX-License-Identifier: Apache-2.0
/// What two scanners of 270 degrees on opposite corners of a robot record in a room, and the one
/// scan all round that a merger would make of them.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

#include "core/random/stream.hpp"
#include "core/scan/scan.hpp"
#include "tests/core/localization/box_world.hpp"

namespace strata::test {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kNoise_m = 0.01;
inline const Pose2 kFront{0.3, 0.2, kPi / 4.0};
inline const Pose2 kBack{-0.3, -0.2, -3.0 * kPi / 4.0};

/// 12 m x 8 m with furniture and a wall across; number: 0, or one where the furniture along the
/// walls is drawn.
inline BoxWorld room(std::uint64_t number = 0) {
  BoxWorld world{{0.0, 0.0, 12.0, 0.2},
                 {0.0, 7.8, 12.0, 8.0},
                 {0.0, 0.0, 0.2, 8.0},
                 {11.8, 0.0, 12.0, 8.0},
                 {5.0, 3.0, 7.4, 5.2}};
  if (number == 0) {
    world.insert(
        world.end(),
        {{0.2, 6.6, 1.7, 7.8}, {10.6, 0.2, 11.8, 1.1}, {3.0, 0.2, 4.1, 0.7}, {8.0, 7.1, 8.9, 7.8}});
    return world;
  }
  RandomStream random(number, StreamId::kTest, 2);
  for (int i = 0; i < 4; ++i) {
    const double x = random.uniform(0.2, 10.3);
    const double width = random.uniform(0.5, 1.5);
    const double depth = random.uniform(0.3, 0.8);
    const bool is_low = i % 2 == 0;
    world.push_back({x, is_low ? 0.2 : 7.8 - depth, x + width, is_low ? 0.2 + depth : 7.8});
  }
  return world;
}

inline Scan look(const BoxWorld& world, const Pose2& robot, const Pose2& mounting, double field_rad,
                 int beams, double stamp_s, RandomStream& random) {
  const Pose2 laser = robot * mounting;
  Scan scan;
  scan.stamp = Stamp::from_seconds(stamp_s);
  scan.angle_min_rad = static_cast<float>(-0.5 * field_rad);
  scan.angle_increment_rad = static_cast<float>(field_rad / (beams - 1));
  scan.range_min_m = 0.05F;
  scan.range_max_m = 20.0F;
  scan.robot_from_laser = mounting;
  for (int i = 0; i < beams; ++i) {
    const double bearing = laser.theta + scan.bearing_rad(static_cast<std::size_t>(i));
    scan.ranges_m.push_back(
        static_cast<float>(cast(world, laser.x, laser.y, bearing) + kNoise_m * random.normal()));
  }
  return scan;
}

/// Round the furniture in the middle.
inline Pose2 place(double t) {
  const double phase = 0.14 * t;
  const double x = 6.2 + 4.0 * std::cos(phase);
  const double y = 4.1 + 2.4 * std::sin(phase);
  const double heading = std::atan2(2.4 * std::cos(phase), -4.0 * std::sin(phase));
  return {x, y, heading + 0.4 * std::sin(0.7 * t)};
}

struct Log {
  std::vector<Observation> observations;
  std::vector<Pose2> truths;
};

/// kMerged: one scanner all round in the robot's middle, as an ideal merger would have it.
/// kMerger: what a merger makes of the two in step.
enum class Rig { kMerged, kMerger, kTwoInTurn, kTwoInStep };

/// The hits of both as seen from the robot's middle, the nearest in each of 720 directions, as the
/// mergers of ROS do it.
inline Scan merger_of(const Scan& front, const Scan& back) {
  constexpr std::size_t kBeams = 720;
  Scan merged;
  merged.stamp = front.stamp;
  merged.angle_min_rad = static_cast<float>(-kPi);
  merged.angle_increment_rad = static_cast<float>(2.0 * kPi / kBeams);
  merged.range_min_m = front.range_min_m;
  merged.range_max_m = front.range_max_m;
  merged.ranges_m.assign(kBeams, std::numeric_limits<float>::quiet_NaN());
  for (const Scan* scan : {&front, &back}) {
    const Endpoints hits = endpoints_in_robot(*scan);
    for (std::size_t i = 0; i < hits.size(); ++i) {
      const double bearing = std::atan2(hits.y_m[i], hits.x_m[i]);
      const auto beam =
          static_cast<std::size_t>(std::lround((bearing + kPi) * kBeams / (2.0 * kPi))) % kBeams;
      const auto range_m = static_cast<float>(std::hypot(hits.x_m[i], hits.y_m[i]));
      if (!(merged.ranges_m[beam] <= range_m)) merged.ranges_m[beam] = range_m;
    }
  }
  return merged;
}

/// 10 Hz a scanner, one and a third of a round.
inline Log record(Rig rig, std::uint64_t seed, double duration_s = 60.0, std::uint64_t number = 0) {
  const BoxWorld world = room(number);
  RandomStream noise(seed, StreamId::kTest);
  RandomStream wheels(seed, StreamId::kTest, 1);
  Log log;
  Pose2 odom = place(0.0);
  constexpr double kStepS = 0.05;
  const auto add = [&](const Pose2& robot, const Scan& scan) {
    log.observations.push_back({0, scan, odom, true});
    log.truths.push_back(robot);
  };
  for (int i = 0; i * kStepS < duration_s; ++i) {
    const double t = i * kStepS;
    const Pose2 robot = place(t);
    if (i > 0) {
      const Pose2 motion = between(place(t - kStepS), robot);
      odom = odom * Pose2{motion.x * (1.02 + 0.1 * wheels.normal()), motion.y,
                          motion.theta * (1.02 + 0.1 * wheels.normal())};
    }
    const bool is_even = i % 2 == 0;
    if (rig == Rig::kMerged && is_even) {
      add(robot, look(world, robot, {}, 2.0 * kPi - 2.0 * kPi / 720.0, 720, t, noise));
    }
    if (rig == Rig::kMerger && is_even) {
      const Scan front = look(world, robot, kFront, 1.5 * kPi, 541, t, noise);
      add(robot, merger_of(front, look(world, robot, kBack, 1.5 * kPi, 541, t, noise)));
    }
    if ((rig == Rig::kTwoInTurn || rig == Rig::kTwoInStep) && is_even) {
      add(robot, look(world, robot, kFront, 1.5 * kPi, 541, t, noise));
    }
    if ((rig == Rig::kTwoInTurn && !is_even) || (rig == Rig::kTwoInStep && is_even)) {
      add(robot, look(world, robot, kBack, 1.5 * kPi, 541, t, noise));
    }
  }
  return log;
}

}  // namespace strata::test
