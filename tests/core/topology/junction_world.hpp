// SPDX-License-Identifier: Apache-2.0
/// A building of junctions that look alike, and a robot that drives from one to the next.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "core/geometry/angle.hpp"
#include "core/random/stream.hpp"
#include "core/topology/topology_filter.hpp"

namespace strata::topology::test_world {

/// Where a junction lies and what it looks like; equal kinds cannot be told apart by their walls,
/// unless their corridors are of other widths and lengths.
struct Junction {
  double x_m = 0.0;
  double y_m = 0.0;
  int kind = 0;
  int corridors = 0;  ///< seed of each one's width and length; 0: all alike
};

/// Walls around a junction in its own frame, a point every 10 cm: corridors lead off where the
/// kind's bits say (1 east, 2 north, 4 west, 8 south); kind / 16 says how wide they are.
inline std::vector<Eigen::Vector2d> wall_points(const Junction& junction) {
  const int kind = junction.kind;
  RandomStream random(static_cast<std::uint64_t>(junction.corridors), StreamId::kTest, 32);
  std::vector<Eigen::Vector2d> points;
  const auto wall = [&](Eigen::Vector2d from, Eigen::Vector2d to) {
    const int steps = static_cast<int>((to - from).norm() / 0.1);
    for (int i = 0; i <= steps; ++i) {
      points.push_back(from + (to - from) * (static_cast<double>(i) / steps));
    }
  };
  for (int side = 0; side < 4; ++side) {
    double half_m = 1.0 + 0.3 * (kind / 16);
    double end_m = 5.0;
    if (junction.corridors != 0) {
      half_m *= random.uniform(0.7, 1.3);
      end_m = random.uniform(2.5, 5.0);
    }
    const Pose2 turned{0.0, 0.0, side * std::numbers::pi / 2.0};
    if ((kind >> side) % 2 == 1) {
      wall(turned * Eigen::Vector2d(half_m, half_m), turned * Eigen::Vector2d(end_m, half_m));
      wall(turned * Eigen::Vector2d(half_m, -half_m), turned * Eigen::Vector2d(end_m, -half_m));
    } else {
      wall(turned * Eigen::Vector2d(half_m, -half_m), turned * Eigen::Vector2d(half_m, half_m));
    }
  }
  return points;
}

struct Drive {
  std::vector<LandmarkVisit> visits;
  Labels truth;
  std::vector<Pose2> poses;  ///< true, map_from_robot
};

/// The robot visits junctions by index; it arrives heading along its way, within 0.2 m of the
/// middle. Odometry is as noisy as the config says.
inline Drive drive(const std::vector<Junction>& junctions, const std::vector<int>& order,
                   const OdometryNoiseConfig& noise, std::uint64_t seed) {
  RandomStream random(seed, StreamId::kTest, 31);
  Drive result;
  result.truth = canonical(order);
  Pose2 odom;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Junction& at = junctions[static_cast<std::size_t>(order[i])];
    const Junction& from = junctions[static_cast<std::size_t>(i == 0 ? order[i] : order[i - 1])];
    Pose2 pose{at.x_m + random.normal(0.0, 0.1), at.y_m + random.normal(0.0, 0.1),
               std::atan2(at.y_m - from.y_m, at.x_m - from.x_m) + random.normal(0.0, 0.03)};
    LandmarkVisit visit;
    visit.stamp = {static_cast<std::int64_t>(i + 1) * 1'000'000'000};
    if (i == 0) {
      odom = pose;
    } else {
      Pose2 step = between(result.poses.back(), pose);
      visit.path_length_m = step.translation().norm();
      const OdometryFactor factor = odometry_step(step, visit.path_length_m, noise);
      step.x += random.normal(0.0, std::sqrt(factor.covariance(0, 0)));
      step.y += random.normal(0.0, std::sqrt(factor.covariance(1, 1)));
      step.theta = wrap_angle(step.theta + random.normal(0.0, std::sqrt(factor.covariance(2, 2))));
      odom = odom * step;
    }
    visit.odom_from_robot = odom;
    const Pose2 robot_from_junction = inverse(pose) * Pose2{at.x_m, at.y_m, 0.0};
    std::vector<Eigen::Vector2d> seen;
    for (const Eigen::Vector2d& point : wall_points(at)) {
      seen.push_back(robot_from_junction * point +
                     Eigen::Vector2d(random.normal(0.0, 0.02), random.normal(0.0, 0.02)));
    }
    visit.cloud = with_normals(seen, 5);
    result.visits.push_back(std::move(visit));
    result.poses.push_back(pose);
  }
  return result;
}

/// Nine junctions 10 m apart that show three looks, three times each.
inline std::vector<Junction> nine_junctions() {
  std::vector<Junction> junctions;
  const int kinds[3] = {15, 16 + 7, 32 + 13};
  for (int i = 0; i < 9; ++i) {
    junctions.push_back({10.0 * (i % 3), 10.0 * (i / 3), kinds[(i + i / 3) % 3]});
  }
  return junctions;
}

/// Twelve visits of the nine, about 120 m; three junctions are met again.
inline std::vector<int> twelve_visits() { return {0, 1, 2, 5, 4, 3, 6, 7, 8, 5, 2, 1}; }

/// Fourteen junctions round a block 60 m wide, with a corridor across; two or three of each look.
inline std::vector<Junction> fourteen_junctions() {
  const int kinds[6] = {15, 16 + 7, 32 + 13, 11, 16 + 14, 32 + 15};
  std::vector<Junction> junctions;
  for (int i = 0; i < 7; ++i) junctions.push_back({10.0 * i, 0.0, kinds[i % 6]});
  for (int i = 0; i < 7; ++i) junctions.push_back({60.0 - 10.0 * i, 20.0, kinds[(i + 2) % 6]});
  return junctions;
}

/// Twenty visits, about 250 m: once round, and some of the way again.
inline std::vector<int> twenty_visits() {
  return {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 0, 1, 2, 3, 10, 11};
}

/// As many junctions as asked for, in rows of ten, 10 m apart, of six looks.
inline std::vector<Junction> rows_of_ten(int count) {
  const int kinds[6] = {15, 16 + 7, 32 + 13, 11, 16 + 14, 32 + 15};
  std::vector<Junction> junctions;
  for (int i = 0; i < count; ++i) {
    junctions.push_back({10.0 * (i % 10), 10.0 * (i / 10), kinds[(i + 2 * (i / 10)) % 6]});
  }
  return junctions;
}

/// The same, of which no two look alike.
inline std::vector<Junction> unlike_rows_of_ten(int count) {
  std::vector<Junction> junctions = rows_of_ten(count);
  for (int i = 0; i < count; ++i) junctions[static_cast<std::size_t>(i)].corridors = i + 1;
  return junctions;
}

/// Along one row and back along the next, whose first two junctions close the loop; and so on.
/// count: a multiple of twenty.
inline std::vector<int> row_by_row(int count) {
  std::vector<int> order;
  for (int pair = 0; pair < count; pair += 20) {
    for (int i = 0; i < 10; ++i) order.push_back(pair + i);
    for (int i = 0; i < 10; ++i) order.push_back(pair + 19 - i);
    order.push_back(pair);
    order.push_back(pair + 10);
  }
  return order;
}

}  // namespace strata::topology::test_world
