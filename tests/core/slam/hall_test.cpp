// SPDX-License-Identifier: Apache-2.0
// Large halls: stands that all look alike, and surfaces far from where the robot goes.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/parallel.hpp"
#include "core/geometry/pose2_gaussian.hpp"
#include "core/slam/local_map_agreement.hpp"
#include "core/slam/local_map_graph.hpp"
#include "core/tracking/local_map.hpp"
#include "core/tracking/tracker.hpp"
#include "tests/core/registration/room_world.hpp"

namespace strata::slam {
namespace {

using test::scan_of;
using test::Wall;

constexpr double kResolutionM = 0.05;

/// Two rows of stands along x, 1.2 m from tooth to tooth, 2 m apart.
constexpr double kToothM = 1.2;
std::vector<Wall> stands() {
  std::vector<Wall> walls;
  for (int i = -5; i < 30; ++i) {
    const double x = kToothM * i;
    const double middle = x + 0.5 * kToothM;
    for (const double side : {-1.0, 1.0}) {
      walls.push_back({x, side, middle, 1.4 * side});
      walls.push_back({middle, 1.4 * side, x + kToothM, side});
    }
  }
  return walls;
}

/// Small steps, until it is known how good the odometry is, then steps of a tooth.
std::vector<Pose2> past_the_stands() {
  std::vector<Pose2> path;
  double x = 0.0;
  for (int i = 0; i < 20; ++i) path.push_back({x += 0.3, 0.0, 0.0});
  for (int i = 0; i < 10; ++i) path.push_back({x += kToothM, 0.0, 0.0});
  return path;
}

TEST(Hall, StandsThatLookAlikeSeldomMoveARobotBackWhoseOdometryWasGood) {
  const std::vector<Pose2> path = past_the_stands();
  int held = 0;
  for (std::uint64_t drive = 0; drive < 6; ++drive) {
    Tracker tracker({}, kResolutionM, 0, path.front());
    double worst_m = 0.0;
    for (std::size_t i = 0; i < path.size(); ++i) {
      const Scan scan = scan_of(stands(), path[i], 0.5 * static_cast<double>(i), 0.05,
                                i + 1 + 100 * drive, 360, 2.0 * std::numbers::pi, 4.2);
      const Pose2 found = tracker.add(scan, &path[i], i).run_from_robot.mean;
      worst_m = std::max(worst_m, translation_distance(found, path[i]));
    }
    held += worst_m < 0.5 * kToothM ? 1 : 0;
  }
  EXPECT_GE(held, 3) << "of six drives";
}

TEST(Hall, AnOdometryThatWasGoodIsStillNotBelievedAgainstAllBeams) {
  // In a room that looks the same from nowhere else it counts on while the robot stands.
  Tracker tracker({}, kResolutionM, 0, {2.0, 4.0, 0.0});
  Pose2 at{2.0, 4.0, 0.0};
  Pose2 counted = at;
  for (std::size_t i = 0; i < 60; ++i) {
    if (i > 0 && i < 40) at.x += 0.05;
    if (i > 0) counted.x += i < 40 ? 0.05 : 0.8;
    const Scan scan = scan_of(test::room(), at, 0.5 * static_cast<double>(i), 0.01, i + 1, 360,
                              2.0 * std::numbers::pi);
    const Pose2 found = tracker.add(scan, &counted, i).run_from_robot.mean;
    ASSERT_LT(translation_distance(found, at), 0.1) << "scan " << i;
  }
}

/// 40 m x 24 m with some pillars.
std::vector<Wall> hall() {
  std::vector<Wall> walls{
      {-20, -12, 20, -12}, {20, -12, 20, 12}, {20, 12, -20, 12}, {-20, 12, -20, -12}};
  const auto pillar = [&](double x, double y, double w) {
    walls.insert(
        walls.end(),
        {{x, y, x + w, y}, {x + w, y, x + w, y + w}, {x + w, y + w, x, y + w}, {x, y + w, x, y}});
  };
  pillar(-9.0, 3.0, 1.0);
  pillar(-2.0, -6.0, 1.5);
  pillar(7.0, 5.0, 0.8);
  pillar(11.0, -4.0, 1.2);
  return walls;
}

/// Seen from a few places beside `from` with beams of 180 degrees; the robot believes that it
/// looked from `drift` away.
LocalMap local_map_at(const Pose2& from, const Pose2& drift, std::size_t first_scan) {
  SurfaceMap map(kResolutionM, {});
  for (int i = 0; i < 12; ++i) {
    const Pose2 pose = from * Pose2{0.2 * i, 0.05 * i, 0.0};
    const Scan scan = scan_of(hall(), pose, i, 0.005, 1, 361, std::numbers::pi, 30.0);
    map.add(scan, drift * pose, {}, 30.0);
  }
  return make_local_map(map, 0, drift * from, first_scan, first_scan + 12);
}

/// A robot that saw nothing on the way there and back.
LocalMap blind_local_map(std::size_t first_scan, double way_m = 100.0) {
  LocalMap local_map;
  local_map.first_scan = first_scan;
  local_map.last_scan = first_scan + 12;
  local_map.run_from_local_map = {0.0, -way_m, 0.0};
  return local_map;
}

TEST(Hall, IsClosedOverWallsFartherApartThanASearchReachesIndoors) {
  // The first looks from one corner to the other end, the second from beside the other side.
  const Pose2 first{-10.0, -8.0, 0.2};
  const Pose2 second{8.0, 6.0, 0.0};
  const LocalMap a = local_map_at(first, {}, 0);
  const LocalMap b = local_map_at(second, {0.3, -0.2, 0.0}, 36);
  const Eigen::Vector2d apart =
      a.run_from_local_map * a.center_m - b.run_from_local_map * b.center_m;
  ASSERT_GT(apart.norm(), 4.0 + 8.0);
  WorkerPool pool(1);
  ClosureConfig config;
  config.max_window_m = 8.0;
  LocalMapGraph graph(config, {}, {}, kResolutionM, pool);
  graph.add(a, std::nullopt);
  graph.add(blind_local_map(12), std::nullopt);
  graph.add(blind_local_map(24), std::nullopt);
  graph.add(b, std::nullopt);
  EXPECT_EQ(graph.closures(), 1U);
  EXPECT_LT(translation_distance(graph.map_from_local_map(3), second), 0.05);
  graph.tighten(2, nullptr);
  EXPECT_EQ(graph.closures(), 1U);
  EXPECT_LT(translation_distance(graph.map_from_local_map(3), second), 0.05);
}

TEST(Hall, IsClosedAsFarAsAWayOf500MetresMayHaveDrifted) {
  // 3% of 500 m.
  const Pose2 here{-10.0, -8.0, 0.2};
  const LocalMap back = local_map_at(here, {11.0, -6.0, 0.1}, 36);
  for (const double window_m : {8.0, ClosureConfig{}.max_window_m}) {
    ClosureConfig config;
    config.max_window_m = window_m;
    WorkerPool pool(1);
    LocalMapGraph graph(config, {}, {}, kResolutionM, pool);
    graph.add(local_map_at(here, {}, 0), std::nullopt);
    graph.add(blind_local_map(12, 250.0), std::nullopt);
    graph.add(blind_local_map(24, 250.0), std::nullopt);
    graph.add(back, std::nullopt);
    EXPECT_EQ(graph.closures(), window_m > 8.0 ? 1U : 0U);
    EXPECT_EQ(translation_distance(graph.map_from_local_map(3), here) < 0.05, window_m > 8.0);
  }
}

TEST(Hall, IsNotClosedFromAfarWherePosesOfTheLogHoldIt) {
  const Pose2 first{-10.0, -8.0, 0.2};
  const Pose2 second{8.0, 6.0, 0.0};
  const Eigen::Matrix3d covariance = pose_covariance(0.1, 0.01);
  WorkerPool pool(1);
  LocalMapGraph graph(ClosureConfig{}, {}, {}, kResolutionM, pool);
  graph.add(local_map_at(first, {}, 0), Pose2Gaussian{first, covariance});
  graph.add(blind_local_map(12), std::nullopt);
  graph.add(blind_local_map(24), std::nullopt);
  graph.add(local_map_at(second, {}, 36), Pose2Gaussian{second, covariance});
  EXPECT_EQ(graph.closures(), 0U);
  graph.tighten(1, nullptr);
  EXPECT_EQ(graph.closures(), 0U);
}

Endpoints cross(double half_x_m, double half_y_m) {
  Endpoints view;
  for (const double x : {-half_x_m, half_x_m}) {
    for (const double y : {-half_y_m, half_y_m}) {
      view.x_m.push_back(7.0 + x);
      view.y_m.push_back(y - 50.0);
      view.beam.push_back(0);
    }
  }
  return view;
}

TEST(LocalMap, SeesNoFartherToAllSidesThanAcrossACorridor) {
  EXPECT_EQ(breadth_m({}), 0.0);
  EXPECT_NEAR(breadth_m(cross(3.0, 3.0)), std::sqrt(18.0), 1e-9);
  EXPECT_NEAR(breadth_m(cross(30.0, 1.0)), std::numbers::sqrt2, 1e-9);
  EXPECT_NEAR(breadth_m(cross(1.0, 30.0)), std::numbers::sqrt2, 1e-9);
}

}  // namespace
}  // namespace strata::slam
