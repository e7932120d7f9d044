// SPDX-License-Identifier: Apache-2.0
// What beams without return do to SLAM's maps, and do not do to its poses.
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "core/random/stream.hpp"
#include "core/slam/slam.hpp"
#include "tests/core/registration/room_world.hpp"

namespace strata::slam {
namespace {

/// To and fro in a hall that is open in the east, where somebody stands at x = 12 in the first
/// third of the drive; odometry drifts.
std::vector<Observation> drive_before_open_space() {
  const std::vector<test::Wall> hall{
      {0.0, 0.0, 10.0, 0.0}, {0.0, 0.0, 0.0, 4.0}, {0.0, 4.0, 10.0, 4.0},
      {3.0, 0.0, 3.0, 0.5},  {3.0, 0.5, 3.6, 0.5}, {3.6, 0.5, 3.6, 0.0},
      {6.2, 4.0, 6.2, 3.4},  {6.2, 3.4, 7.0, 3.4}, {7.0, 3.4, 7.0, 4.0}};
  std::vector<test::Wall> with_somebody = hall;
  with_somebody.push_back({12.0, 1.7, 12.0, 2.3});
  RandomStream random(3, StreamId::kTest);
  std::vector<Observation> log;
  Pose2 odometry;
  Pose2 last{7.0, 2.0, 0.0};
  for (int i = 0; i < 300; ++i) {
    const double along = 2.0 * std::numbers::pi * i / 150.0;
    const Pose2 pose{6.5 + 0.5 * std::cos(along), 2.0 + 0.3 * std::sin(along),
                     0.2 * std::sin(2.0 * along)};
    odometry = odometry * (inverse(last) * pose) *
               Pose2{0.002 * random.normal(), 0.002 * random.normal(), 0.001 * random.normal()};
    last = pose;
    Observation observation;
    observation.scan = test::scan_of(i < 100 ? with_somebody : hall, pose, 0.2 * i, 0.01, 1, 361,
                                     2.0 * std::numbers::pi, 8.0);
    observation.odom_from_robot = odometry;
    log.push_back(observation);
  }
  return log;
}

SlamResult run(const std::vector<Observation>& log, bool is_used) {
  SlamConfig config;
  config.no_return.is_used = is_used;
  Slam slam(config);
  for (const Observation& observation : log) (void)slam.add(observation);
  return slam.finish();
}

/// Cells where somebody stood that count as an obstacle. The map begins where the robot did.
int cells_of_somebody(const SlamResult& result) {
  const Pose2 map_from_hall = result.scans.front().map_from_robot * inverse(Pose2{7.0, 2.0, 0.0});
  int cells = 0;
  for (double y_m = 1.72; y_m < 2.3; y_m += 0.05) {
    for (double x_m = 11.9; x_m < 12.1; x_m += 0.05) {
      const Eigen::Vector2d at = map_from_hall * Eigen::Vector2d(x_m, y_m);
      const float m = result.filtered.get(result.filtered.cell_at(at));
      if (is_known(m) && is_occupied(m)) ++cells;
    }
  }
  return cells;
}

TEST(Slam, BeamsWithoutReturnFreeItsMapsAndDoNotMoveItsPoses) {
  const std::vector<Observation> log = drive_before_open_space();
  const SlamResult without = run(log, false);
  const SlamResult with = run(log, true);
  EXPECT_EQ(without.drop_outs, DropOuts{});
  EXPECT_GT(with.drop_outs.free_range_m, 5.0);
  ASSERT_EQ(with.scans.size(), without.scans.size());
  for (std::size_t i = 0; i < with.scans.size(); ++i) {
    ASSERT_EQ(with.scans[i].map_from_robot, without.scans[i].map_from_robot) << i;
  }
  EXPECT_EQ(with.log_likelihood, without.log_likelihood);
  EXPECT_EQ(with.iterations, without.iterations);
  EXPECT_GT(cells_of_somebody(without), 5);
  EXPECT_EQ(cells_of_somebody(with), 0);
}

}  // namespace
}  // namespace strata::slam
