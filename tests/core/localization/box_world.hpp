// SPDX-License-Identifier: Apache-2.0
/// A world of axis-aligned boxes with its own ray caster (slabs, no grid), so that the scans of
/// these tests owe nothing to the code under test.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/geometry/pose2.hpp"
#include "core/grid/reflection_grid.hpp"
#include "core/random/stream.hpp"
#include "core/scan/scan.hpp"

namespace strata::test {

struct Box {
  double x0, y0, x1, y1;
};

using BoxWorld = std::vector<Box>;

inline double cast(const BoxWorld& world, double x, double y, double angle) {
  double nearest = std::numeric_limits<double>::infinity();
  const double dx = std::cos(angle);
  const double dy = std::sin(angle);
  for (const Box& box : world) {
    const double tx0 = (box.x0 - x) / dx;
    const double tx1 = (box.x1 - x) / dx;
    const double ty0 = (box.y0 - y) / dy;
    const double ty1 = (box.y1 - y) / dy;
    const double enter = std::max(std::min(tx0, tx1), std::min(ty0, ty1));
    const double leave = std::min(std::max(tx0, tx1), std::max(ty0, ty1));
    if (leave >= std::max(enter, 0.0)) nearest = std::min(nearest, std::max(enter, 0.0));
  }
  return nearest;
}

/// Full-circle scan with noise; beams past max_range are +Inf.
inline Scan make_scan(const BoxWorld& world, const Pose2& robot, double max_range_m, int beams,
                      double noise_m, RandomStream& random, double stamp_s) {
  Scan scan;
  scan.stamp = Stamp::from_seconds(stamp_s);
  scan.angle_min_rad = -3.14159F;
  scan.angle_increment_rad = 6.28318F / static_cast<float>(beams);
  scan.range_min_m = 0.05F;
  scan.range_max_m = static_cast<float>(max_range_m);
  for (int i = 0; i < beams; ++i) {
    const double bearing = scan.bearing_rad(static_cast<std::size_t>(i));
    const double range = cast(world, robot.x, robot.y, robot.theta + bearing);
    const double measured = range + noise_m * random.normal();
    scan.ranges_m.push_back(range < max_range_m ? static_cast<float>(measured)
                                                : std::numeric_limits<float>::infinity());
  }
  return scan;
}

/// Cells whose centre lies in a box are occupied, the others free.
inline ReflectionGrid rasterize(const BoxWorld& world, double resolution_m, const CellRect& rect) {
  ReflectionGrid grid(resolution_m, rect, kUnknownReflection);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const Eigen::Vector2d p = grid.center(grid.cell(i));
    bool is_inside = false;
    for (const Box& b : world) {
      is_inside |= p.x() >= b.x0 && p.x() < b.x1 && p.y() >= b.y0 && p.y() < b.y1;
    }
    grid.values()[i] = is_inside ? 1.0F : 0.0F;
  }
  return grid;
}

/// A driven robot whose odometry has noise: call step() with the true motion.
class Drive {
 public:
  Drive(const Pose2& start, std::uint64_t seed) : truth_(start), random_(seed, StreamId::kTest) {}
  void step(const Pose2& motion) {
    truth_ = truth_ * motion;
    const double t = std::hypot(motion.x, motion.y);
    odom_ =
        odom_ * Pose2{motion.x * (1.0 + 0.05 * random_.normal()) + 0.05 * t * random_.normal(),
                      motion.y,
                      motion.theta * (1.0 + 0.05 * random_.normal()) + 0.02 * t * random_.normal()};
    time_s_ += 0.2;
  }
  [[nodiscard]] const Pose2& truth() const { return truth_; }
  [[nodiscard]] double time_s() const { return time_s_; }
  void kidnap(const Pose2& to) { truth_ = to; }
  Observation look(const BoxWorld& world, double max_range_m = 10.0, int beams = 72) {
    return {0, make_scan(world, truth_, max_range_m, beams, 0.02, random_, time_s_), odom_, true};
  }

 private:
  Pose2 truth_;
  Pose2 odom_;
  RandomStream random_;
  double time_s_ = 0.0;
};

}  // namespace strata::test
