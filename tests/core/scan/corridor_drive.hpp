// SPDX-License-Identifier: Apache-2.0
/// Drives through simple worlds in which returns drop out, for tests of beams without return.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "core/random/stream.hpp"
#include "core/scan/scan.hpp"

namespace strata::test {

inline constexpr float kInf = std::numeric_limits<float>::infinity();
inline constexpr double kReach_m = 8.0;

/// How far it is from a point in a direction at a moment; infinite: there is nothing.
using World = std::function<double(double x_m, double y_m, double angle_rad, double time_s)>;

/// Along x between walls at y = -2 and 2 that have no end.
inline double corridor(double /*x_m*/, double y_m, double angle_rad, double /*time_s*/) {
  const double s = std::sin(angle_rad);
  if (std::abs(s) < 1e-9) return std::numeric_limits<double>::infinity();
  return ((s > 0.0 ? 2.0 : -2.0) - y_m) / s;
}

/// A room of which every wall is in reach.
inline double room(double x_m, double y_m, double angle_rad, double /*time_s*/) {
  const double c = std::cos(angle_rad);
  const double s = std::sin(angle_rad);
  const double along = ((c > 0.0 ? 4.0 : -2.0) - x_m) / c;
  const double across = ((s > 0.0 ? 2.0 : -2.0) - y_m) / s;
  return std::min(along, across);
}

struct Drive {
  std::vector<PosedScan> scans;
  std::vector<std::vector<bool>> lost;  ///< per scan and beam: its return dropped out
};

/// Drives along x at 0.5 m/s with 5 scans a second. drop: how likely a return drops out at a range.
inline Drive drive(const World& world, const std::function<double(double range_m)>& drop,
                   double length_s = 20.0) {
  Drive result;
  RandomStream random(7, StreamId::kTest);
  for (double time_s = 0.0; time_s < length_s; time_s += 0.2) {
    PosedScan posed;
    posed.scan.stamp = Stamp::from_seconds(10.0 + time_s);
    posed.scan.angle_min_rad = -1.57F;
    posed.scan.angle_increment_rad = 0.0175F;
    posed.scan.range_min_m = 0.05F;
    posed.scan.range_max_m = static_cast<float>(kReach_m);
    posed.map_from_robot = {0.1 * time_s, 0.3 * std::sin(time_s), 0.1 * std::cos(time_s)};
    std::vector<bool> lost;
    for (int beam = 0; beam < 180; ++beam) {
      const double angle =
          posed.map_from_robot.theta + posed.scan.bearing_rad(static_cast<std::size_t>(beam));
      const double range = world(posed.map_from_robot.x, posed.map_from_robot.y, angle, time_s) +
                           0.01 * random.normal();
      const bool returns = range < kReach_m;
      lost.push_back(returns && random.bernoulli(drop(range)));
      posed.scan.ranges_m.push_back(returns && !lost.back() ? static_cast<float>(range) : kInf);
    }
    result.scans.push_back(posed);
    result.lost.push_back(lost);
  }
  return result;
}

inline std::function<double(double)> always(double probability) {
  return [=](double) { return probability; };
}

/// The corridor, of which the north wall between x = 0.5 and 1.5 m is away from a moment on.
inline World gate_that_opens(double opens_s) {
  return [=](double x_m, double y_m, double angle_rad, double time_s) {
    const double range = corridor(x_m, y_m, angle_rad, time_s);
    const double at = x_m + range * std::cos(angle_rad);
    const bool is_through = std::sin(angle_rad) > 0.0 && at > 0.5 && at < 1.5;
    return is_through && time_s >= opens_s ? std::numeric_limits<double>::infinity() : range;
  };
}

/// Beams without return that say nothing, of the scans between two times after the start.
inline std::size_t silent_between(const Drive& drive, double from_s, double to_s) {
  std::size_t count = 0;
  for (const PosedScan& posed : drive.scans) {
    const double time_s = posed.scan.stamp.seconds() - 10.0;
    if (time_s >= from_s && time_s < to_s) count += posed.scan.drop_outs.size();
  }
  return count;
}

}  // namespace strata::test
