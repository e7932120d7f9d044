// SPDX-License-Identifier: Apache-2.0
/// A small world of wall segments seen by a laser, for tests of the patch room. Casts rays by
/// intersecting segments in closed form and shares nothing with the code under test.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/geometry/pose2.hpp"
#include "core/patch/patch_map.hpp"
#include "core/random/stream.hpp"
#include "core/scan/scan.hpp"

namespace strata::patch::test_world {

struct Wall {
  double x0, y0, x1, y1;
};

struct ToyWorld {
  std::vector<Wall> walls;

  void add_box(double x0, double y0, double x1, double y1) {
    walls.push_back({x0, y0, x1, y0});
    walls.push_back({x1, y0, x1, y1});
    walls.push_back({x1, y1, x0, y1});
    walls.push_back({x0, y1, x0, y0});
  }
  /// Distance to the nearest wall in the direction, +Inf for none.
  [[nodiscard]] double range(double x, double y, double direction) const {
    const double cx = std::cos(direction);
    const double cy = std::sin(direction);
    double nearest = std::numeric_limits<double>::infinity();
    for (const Wall& w : walls) {
      const double ex = w.x1 - w.x0;
      const double ey = w.y1 - w.y0;
      const double det = cx * ey - cy * ex;
      if (std::abs(det) < 1e-12) continue;
      const double along = ((w.x0 - x) * ey - (w.y0 - y) * ex) / det;
      const double part = ((w.x0 - x) * cy - (w.y0 - y) * cx) / det;
      if (along > 1e-6 && part >= 0.0 && part <= 1.0) nearest = std::min(nearest, along);
    }
    return nearest;
  }
};

/// What a robot of the tests does: scans with 360 beams all round and a range noise of 1 cm, at
/// 5 Hz, while driving straight at 0.5 m/s; all poses of a visit are reported with one error, as a
/// wrong registration would.
struct ToyRobot {
  double range_stddev_m = 0.01;
  double max_range_m = 8.0;
  int beams = 360;

  /// Appends the scans of a drive from a to b that starts at `start_s`.
  void drive(const ToyWorld& world, const Pose2& a, const Pose2& b, int run, double start_s,
             const Pose2& error, RandomStream& random, std::vector<PosedScan>& scans) const {
    const double length = std::hypot(b.x - a.x, b.y - a.y);
    const int steps = std::max(1, static_cast<int>(length / 0.1));
    for (int i = 0; i <= steps; ++i) {
      const Pose2 truth = interpolate(a, b, static_cast<double>(i) / steps);
      PosedScan posed = scan_at(world, truth, random);
      posed.run = run;
      posed.scan.stamp = Stamp::from_seconds(start_s + 0.2 * i);
      posed.map_from_robot = {truth.x + error.x, truth.y + error.y, truth.theta + error.theta};
      scans.push_back(std::move(posed));
    }
  }

  [[nodiscard]] PosedScan scan_at(const ToyWorld& world, const Pose2& truth,
                                  RandomStream& random) const {
    PosedScan posed;
    posed.map_from_robot = truth;
    Scan& scan = posed.scan;
    scan.angle_increment_rad = static_cast<float>(2.0 * 3.14159265358979323846 / beams);
    scan.angle_min_rad = -3.14159265F;
    scan.range_min_m = 0.05F;
    scan.range_max_m = static_cast<float>(max_range_m);
    for (std::size_t i = 0; i < static_cast<std::size_t>(beams); ++i) {
      const double exact = world.range(truth.x, truth.y, truth.theta + scan.bearing_rad(i));
      const double noisy = exact + random.normal(0.0, range_stddev_m);
      scan.ranges_m.push_back(noisy < max_range_m ? static_cast<float>(noisy)
                                                  : std::numeric_limits<float>::infinity());
    }
    return posed;
  }
};

/// An error of pose with the given spreads.
inline Pose2 random_error(double position_stddev_m, double heading_stddev_rad,
                          RandomStream& random) {
  const double x = random.normal(0.0, position_stddev_m);
  const double y = random.normal(0.0, position_stddev_m);
  return {x, y, random.normal(0.0, heading_stddev_rad)};
}

/// A corridor of 12 m x 2.4 m with a room of 4 m x 3 m behind a door gap of 0.9 m at x = 5.5.
inline ToyWorld corridor_with_door(bool is_closed) {
  ToyWorld world;
  world.walls = {{0.0, 0.0, 12.0, 0.0}, {0.0, 0.0, 0.0, 2.4},   {12.0, 0.0, 12.0, 2.4},
                 {0.0, 2.4, 5.05, 2.4}, {5.95, 2.4, 12.0, 2.4}, {4.0, 2.4, 4.0, 5.4},
                 {8.0, 2.4, 8.0, 5.4},  {4.0, 5.4, 8.0, 5.4}};
  // Niches, so that the corridor is not featureless.
  world.add_box(2.0, 0.0, 2.3, 0.2);
  world.add_box(9.0, 2.2, 9.4, 2.4);
  if (is_closed) {
    world.walls.push_back({5.05, 2.4, 5.95, 2.4});
  } else {
    world.walls.push_back({5.05, 2.4, 5.05, 3.3});  // the leaf, swung into the room
  }
  return world;
}

/// How visits follow each other: each a run of its own, or all in one run, 100 s apart.
enum class Visits { kRuns, kOneRun };

/// Drives along corridor_with_door to and fro, once a visit, with the door closed where `closed`
/// says so, each with an error of pose of its own.
inline std::vector<PosedScan> drive_past_door(const std::vector<bool>& closed,
                                              double position_stddev_m, double heading_stddev_rad,
                                              std::uint64_t seed, Visits visits) {
  std::vector<PosedScan> scans;
  for (std::size_t v = 0; v < closed.size(); ++v) {
    RandomStream random(seed, StreamId::kTest, v);
    const Pose2 error = random_error(position_stddev_m, heading_stddev_rad, random);
    const bool back = v % 2 != 0;
    const double y = random.uniform(0.9, 1.5);
    const Pose2 west{1.0, y, back ? 3.14159265 : 0.0};
    const Pose2 east{10.0, y, back ? 3.14159265 : 0.0};
    const bool is_one_run = visits == Visits::kOneRun;
    ToyRobot{}.drive(corridor_with_door(closed[v]), back ? east : west, back ? west : east,
                     is_one_run ? 0 : static_cast<int>(v),
                     is_one_run ? 100.0 * static_cast<double>(v) : 0.0, error, random, scans);
  }
  return scans;
}

/// The door lies on the segment (5.05, 2.4)-(5.95, 2.4); its leaf swings into x = 5.05, y up
/// to 3.3.
inline bool is_at_door(const Submap& submap, double resolution_m) {
  return submap.rect.inflated(4).contains(cell_at({5.5, 2.4}, resolution_m));
}

/// A robot stands in the corridor and watches its door, which is closed, open, closed, ...
inline std::vector<PosedScan> stand_before_door(const std::vector<double>& lasts_s,
                                                std::uint64_t seed) {
  RandomStream random(seed, StreamId::kTest, 5);
  std::vector<PosedScan> scans;
  double at_s = 0.0;
  double until_s = 0.0;
  for (std::size_t i = 0; i < lasts_s.size(); ++i) {
    until_s += lasts_s[i];
    const ToyWorld world = corridor_with_door(i % 2 == 0);
    for (; at_s < until_s - 1e-9; at_s += 0.5) {
      scans.push_back(ToyRobot{}.scan_at(world, {5.0, 0.9, 1.2}, random));
      scans.back().scan.stamp = Stamp::from_seconds(at_s);
    }
  }
  return scans;
}

/// A scan of one beam along +x from (0.025, 0.025), so that it runs through cell row 0.
inline PosedScan beam(double range_m, double stamp_s, int run = 0) {
  PosedScan posed;
  posed.run = run;
  posed.map_from_robot = {0.025, 0.025, 0.0};
  posed.scan.stamp = Stamp::from_seconds(stamp_s);
  posed.scan.range_max_m = 50.0F;
  posed.scan.angle_increment_rad = 0.01F;
  posed.scan.ranges_m = {static_cast<float>(range_m)};
  return posed;
}

}  // namespace strata::patch::test_world
