// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/peers/peer_job.hpp"

#include <cmath>
#include <fstream>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "tests/support/test_data.hpp"

namespace strata::peers {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

/// Walls of a room of 4 m x 3 m whose corner is at the origin, in cells of 0.1 m.
ReflectionGrid room() {
  ReflectionGrid map(0.1, {{-1, -1}, {41, 31}}, kUnknown);
  for (int y = -1; y < 31; ++y) {
    for (int x = -1; x < 41; ++x) {
      const bool is_wall = x < 0 || y < 0 || x > 39 || y > 29;
      map.at({x, y}) = is_wall ? 1.0F : 0.0F;
    }
  }
  return map;
}

/// What a laser with beams all around sees from there.
PeerScan look(const Pose2& pose, const Pose2& odom) {
  PeerScan scan;
  scan.odom_from_robot = odom;
  scan.truth = pose;
  scan.angle_increment_rad = 2.0 * std::acos(-1.0) / 72.0;
  scan.angle_min_rad = -std::acos(-1.0);
  scan.range_max_m = 10.0;
  for (int i = 0; i < 72; ++i) {
    const double bearing = pose.theta + scan.angle_min_rad + i * scan.angle_increment_rad;
    const double c = std::cos(bearing);
    const double s = std::sin(bearing);
    const double to_x = c > 0.0 ? (4.0 - pose.x) / c : c < 0.0 ? -pose.x / c : 1e9;
    const double to_y = s > 0.0 ? (3.0 - pose.y) / s : s < 0.0 ? -pose.y / s : 1e9;
    scan.ranges_m.push_back(std::min(to_x, to_y));
  }
  return scan;
}

PeerJob drive() {
  PeerJob job;
  job.map = peer_map(room());
  for (int i = 0; i < 20; ++i) {
    const Pose2 pose{1.0 + 0.1 * i, 1.0 + 0.02 * i, 0.05 * i};
    job.scans.push_back(look(pose, Pose2{7.0, -3.0, 1.0} * pose));  // odometry has its own origin
  }
  job.start.mean = {1.0, 1.0, 0.0};
  job.start.covariance = Eigen::Vector3d(0.01, 0.01, 0.0025).asDiagonal();
  job.particles = 500;
  job.seed = 7;
  return job;
}

TEST(PeerJob, ComesBackFromJsonAsItWas) {
  PeerJob job = drive();
  job.scans[3].ranges_m[5] = std::numeric_limits<double>::quiet_NaN();
  job.scans[4].truth.reset();
  const nlohmann::json once = to_json(job);
  const PeerJob back = job_from_json(nlohmann::json::parse(once.dump()));
  EXPECT_EQ(to_json(back), once);
  EXPECT_TRUE(std::isnan(back.scans[3].ranges_m[5]));
  EXPECT_FALSE(back.scans[4].truth);
  EXPECT_EQ(back.scans[2].odom_from_robot.x, job.scans[2].odom_from_robot.x);
}

TEST(PeerJob, MapHasItsCornerAndRowsFromBelow) {
  ReflectionGrid map(0.5, {{-2, 4}, {1, 6}}, kUnknown);
  map.at({0, 4}) = 1.0F;
  map.at({-2, 5}) = 0.0F;
  const PeerMap peer = peer_map(map);
  EXPECT_EQ(peer.origin_x_m, -1.0);
  EXPECT_EQ(peer.origin_y_m, 2.0);
  EXPECT_EQ(peer.width, 3);
  const int u = PeerMap::kUnknown;
  EXPECT_THAT(peer.cells, testing::ElementsAre(u, u, PeerMap::kOccupied, PeerMap::kFree, u, u));
}

TEST(PeerJob, AnAnswerToAnotherJobIsRefused) {
  PeerResult result;
  result.errors_m = {0.1};
  result.errors_rad = {std::nullopt};
  result.estimates = {Pose2{1.0, 2.0, 3.0}};
  result.update_ms = {0.5};
  const nlohmann::json answer = to_json(result);
  EXPECT_EQ(result_from_json(answer, 1).estimates[0].y, 2.0);
  EXPECT_THROW((void)result_from_json(answer, 2), InputError);
  EXPECT_THROW((void)result_from_json(nlohmann::json::object(), 1), InputError);
}

TEST(PeerJob, APeerThatFailsIsAnError) {
  const test::TemporaryDirectory folder;
  EXPECT_THROW((void)run_peer("/bin/false", drive(), folder.path()), Error);
  EXPECT_THROW((void)run_peer("/no/such/peer", drive(), folder.path()), Error);
  EXPECT_THROW((void)run_peer("/bin/true", drive(), folder.path()), InputError) << "no answer";
}

TEST(PeerJob, MrptFollowsARobotThroughARoom) {
#ifdef STRATA_PEER_MRPT
  const test::TemporaryDirectory folder;
  const PeerJob job = drive();
  const PeerResult result = run_peer(STRATA_PEER_MRPT, job, folder.path());
  ASSERT_EQ(result.errors_m.size(), job.scans.size());
  for (std::size_t i = 0; i < job.scans.size(); ++i) {
    EXPECT_LT(*result.errors_m[i], 0.3) << i;
    EXPECT_LT(*result.errors_rad[i], 0.2) << i;
    EXPECT_LT((result.estimates[i].translation() - job.scans[i].truth->translation()).norm(), 0.2);
  }
#else
  GTEST_SKIP() << "MRPT is not installed: tools/install-packages --peers";
#endif
}

}  // namespace
}  // namespace strata::peers
