// SPDX-License-Identifier: Apache-2.0
#include "core/tracking/pose_choice.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "tests/core/registration/room_world.hpp"

namespace strata::slam {
namespace {

/// Walls 3 m to the left and right, and one ahead at x = 6.
SurfaceMap seen_from_the_origin() {
  const std::vector<test::Wall> walls{
      {-9.0, -3.0, 6.0, -3.0}, {-9.0, 3.0, 6.0, 3.0}, {6.0, -3.0, 6.0, 3.0}};
  SurfaceMap map(0.05, {});
  const Pose2 pose{0.0, 0.0, 0.0};
  const Scan scan = test::scan_of(walls, pose, 0.0, 0.0, 1, 720, 0.5 * std::numbers::pi);
  map.add(scan, pose * scan.robot_from_laser, {}, 30.0);
  return map;
}

Endpoints one_end(double x_m, double y_m) {
  Endpoints ends;
  ends.x_m = {x_m};
  ends.y_m = {y_m};
  ends.beam = {0};
  return ends;
}

// ahead: where the end lies at the pose that the map was seen from.
double likelier_ahead(double ahead_m, const Pose2& other) {
  return likelier_by(other, {0.0, 0.0, 0.0}, one_end(ahead_m, 0.0), seen_from_the_origin(), {});
}

TEST(PoseChoice, ABeamThatEndsAtAWallThereAndInTheOpenHereSpeaksForThere) {
  const registration::MatchConfig config;
  const double most = std::log1p(config.hit_weight / (1.0 - config.hit_weight));
  EXPECT_NEAR(likelier_ahead(5.0, {1.0, 0.0, 0.0}), most, 0.1);
  EXPECT_NEAR(likelier_ahead(6.0, {-1.0, 0.0, 0.0}), -most, 0.1);
  EXPECT_NEAR(likelier_ahead(4.0, {1.0, 0.0, 0.0}), 0.0, 1e-9) << "in the open at both";
}

// Beside one that ends in the open from both poses. Behind the origin nobody has looked.
TEST(PoseChoice, ABeamThatEndsWhereNobodyHasSeenSpeaksForNeither) {
  const Pose2 facing_back{5.0, 0.0, std::numbers::pi};
  Endpoints ends = one_end(-1.0, 0.0);
  ends.x_m.push_back(3.0);
  ends.y_m.push_back(0.0);
  ends.beam.push_back(1);
  const SurfaceMap map = seen_from_the_origin();
  EXPECT_EQ(likelier_by(facing_back, {}, ends, map, {}), 0.0) << "at the wall there, unknown here";
  EXPECT_EQ(likelier_by({}, facing_back, ends, map, {}), 0.0);
}

TEST(PoseChoice, ABeamThatGoesThroughAWallSpeaksAgainstThatPose) {
  const registration::MatchConfig config;
  const double most = std::log1p(config.hit_weight / (1.0 - config.hit_weight));
  Endpoints ends = one_end(7.0, 0.0);
  for (std::uint32_t beam = 1; beam < 4; ++beam) {  // enough that are known
    ends.x_m.push_back(3.0);
    ends.y_m.push_back(0.1 * static_cast<double>(beam));
    ends.beam.push_back(beam);
  }
  EXPECT_NEAR(likelier_by({-1.0, 0.0, 0.0}, {}, ends, seen_from_the_origin(), {}), most, 0.1);
}

// Ranges are noisy, and walls are a cell thick.
TEST(PoseChoice, ABeamThatEndsJustBehindAWallDoesNotGoThroughIt) {
  Endpoints ends = one_end(6.1, 0.0);
  ends.x_m.push_back(3.0);
  ends.y_m.push_back(0.0);
  ends.beam.push_back(1);
  EXPECT_EQ(likelier_by({-1.0, 0.0, 0.0}, {}, ends, seen_from_the_origin(), {}), 0.0);
}

TEST(PoseChoice, APoseFromWhichAllIsUnknownDoesNotWinByThat) {
  const registration::MatchConfig config;
  const double most = std::log1p(config.hit_weight / (1.0 - config.hit_weight));
  const Pose2 facing_back{5.0, 0.0, std::numbers::pi};
  EXPECT_NEAR(likelier_by(facing_back, {}, one_end(-1.0, 0.0), seen_from_the_origin(), {}), most,
              0.1);
}

TEST(PoseChoice, OdometryObjectsByItsDoubtToLookAlikesOnly) {
  const Pose2Gaussian guess{{0.0, 0.0, 0.0}, pose_covariance(0.02, 0.02)};
  const Pose2 near_by{0.5, 0.0, 0.0};
  const Pose2 far_off{0.7, 0.0, 0.0};
  for (const double doubt : {1.0, 0.5, 0.2}) {
    EXPECT_NEAR(odder_by(near_by, guess.mean, guess, doubt), 6.0, 1e-9);
    EXPECT_NEAR(odder_by(far_off, guess.mean, guess, doubt),
                std::min(6.0 / doubt, 2.0 * std::log1p(35.0 * 35.0)), 1e-9);
  }
  EXPECT_NEAR(odder_by({0.02, 0.0, 0.0}, guess.mean, guess, 1.0), 2.0 * std::log(2.0), 1e-9);
  EXPECT_NEAR(odder_by(guess.mean, {0.02, 0.0, 0.0}, guess, 1.0), -2.0 * std::log(2.0), 1e-9);
}

}  // namespace
}  // namespace strata::slam
