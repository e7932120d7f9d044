// SPDX-License-Identifier: Apache-2.0
/// A robot that circles in a square room, somebody who walks across it, and filters as the paper
/// has them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

#include "core/beam_filter/beam_filter.hpp"
#include "core/random/stream.hpp"
#include "core/scan/scan.hpp"

namespace strata::beam_filter {

inline constexpr double kHalfRoom_m = 4.0;
inline constexpr std::size_t kBeams = 180;

/// Distance to the walls of the square room |x|, |y| <= 4 m.
inline double range_to_walls(double x, double y, double angle) {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  const double along_x =
      std::abs(c) < 1e-12 ? 1e9 : ((c > 0.0 ? kHalfRoom_m : -kHalfRoom_m) - x) / c;
  const double along_y =
      std::abs(s) < 1e-12 ? 1e9 : ((s > 0.0 ? kHalfRoom_m : -kHalfRoom_m) - y) / s;
  return std::min(along_x, along_y);
}

/// Distance to a disc, or infinity.
inline double range_to_disc(double x, double y, double angle, double center_x, double center_y,
                            double radius) {
  const double along = (center_x - x) * std::cos(angle) + (center_y - y) * std::sin(angle);
  const double across = -(center_x - x) * std::sin(angle) + (center_y - y) * std::cos(angle);
  if (along <= 0.0 || std::abs(across) >= radius) return std::numeric_limits<double>::infinity();
  return along - std::sqrt(radius * radius - across * across);
}

struct Room {
  std::vector<PosedScan> scans;
  std::vector<std::vector<bool>> is_dynamic;  ///< truth per scan and beam
};

/// A robot that drives a circle in the square room, with or without a person who walks across.
inline Room make_room(int count, bool with_walker, std::uint64_t seed) {
  Room room;
  for (int t = 0; t < count; ++t) {
    RandomStream random(seed, StreamId::kTest, static_cast<std::uint64_t>(t));
    PosedScan posed;
    const double phase = 2.0 * std::numbers::pi * t / count;
    posed.map_from_robot = {1.5 * std::cos(phase), 1.5 * std::sin(phase),
                            random.uniform(-3.0, 3.0)};
    posed.scan.angle_min_rad = static_cast<float>(-std::numbers::pi);
    posed.scan.angle_increment_rad = static_cast<float>(2.0 * std::numbers::pi / kBeams);
    posed.scan.range_max_m = 20.0F;
    posed.scan.robot_from_laser = {0.1, 0.0, 0.0};
    const Pose2 laser = posed.map_from_laser();
    const double walker_x = 3.4 * std::cos(7.3 * phase);
    const double walker_y = 3.4 * std::sin(4.1 * phase);
    std::vector<bool> dynamic;
    for (std::size_t n = 0; n < kBeams; ++n) {
      const double angle = laser.theta + posed.scan.bearing_rad(n);
      const double wall = range_to_walls(laser.x, laser.y, angle);
      const double walker = with_walker
                                ? range_to_disc(laser.x, laser.y, angle, walker_x, walker_y, 0.25)
                                : std::numeric_limits<double>::infinity();
      // The wall lies within a cell, not on a border that noise would cross.
      const bool hits_walker = walker < wall - 0.3;
      posed.scan.ranges_m.push_back(
          static_cast<float>((hits_walker ? walker : wall + 0.02) + random.normal(0.0, 0.005)));
      dynamic.push_back(hits_walker);
    }
    room.scans.push_back(posed);
    room.is_dynamic.push_back(dynamic);
  }
  return room;
}

/// As the paper has it: each cell by itself.
inline BeamFilterConfig exact_config() {
  BeamFilterConfig config;
  config.endpoint_tolerance = false;
  return config;
}

inline BeamFilterConfig iterate_config(int iterations) {
  BeamFilterConfig config = exact_config();
  config.mode = Mode::kIterate;
  config.max_iterations = iterations;
  config.min_gain = 0.0;
  return config;
}

}  // namespace strata::beam_filter
