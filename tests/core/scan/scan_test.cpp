// SPDX-License-Identifier: Apache-2.0
#include "core/scan/scan.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "core/scan/endpoints.hpp"
#include "core/scan/range_limit.hpp"

namespace strata {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

Scan quarter_turns(std::vector<float> ranges) {
  Scan scan;
  scan.angle_min_rad = 0.0F;
  scan.angle_increment_rad = static_cast<float>(std::numbers::pi / 2.0);
  scan.range_min_m = 0.1F;
  scan.range_max_m = 10.0F;
  scan.ranges_m = std::move(ranges);
  return scan;
}

TEST(Scan, TellsTheKindsOfReadingsApart) {
  const Scan scan =
      quarter_turns({1.0F, kInf, -kInf, kNan, 10.0F, 11.0F, 0.05F, 0.1F, -1.0F, 0.0F});
  const BeamKind expected[] = {BeamKind::kHit,      BeamKind::kNoReturn, BeamKind::kTooClose,
                               BeamKind::kInvalid,  BeamKind::kNoReturn, BeamKind::kNoReturn,
                               BeamKind::kTooClose, BeamKind::kHit,      BeamKind::kTooClose,
                               BeamKind::kTooClose};
  for (std::size_t i = 0; i < scan.size(); ++i) EXPECT_EQ(scan.kind(i), expected[i]) << i;
  const BeamCounts counts = count_beams(scan);
  EXPECT_EQ(counts.hits, 2U);
  EXPECT_EQ(counts.no_returns, 3U);
  EXPECT_EQ(counts.too_close, 4U);
  EXPECT_EQ(counts.invalid, 1U);
}

TEST(Scan, TakesAZeroRangeForNoHitEvenWithoutALeastRange) {
  Scan scan = quarter_turns({0.0F});
  scan.range_min_m = 0.0F;
  EXPECT_EQ(scan.kind(0), BeamKind::kTooClose);
}

TEST(Scan, TakesAReadingThatNoScannerGivesForNoReturnWhateverItsLimit) {
  for (const float range_max : {kInf, 1e30F, kNan}) {
    Scan scan = quarter_turns({1e30F, 3e38F, 5000.0F, 900.0F, kInf, kNan, -1e30F});
    scan.range_max_m = range_max;
    const BeamKind expected[] = {BeamKind::kNoReturn, BeamKind::kNoReturn, BeamKind::kNoReturn,
                                 BeamKind::kHit,      BeamKind::kNoReturn, BeamKind::kInvalid,
                                 BeamKind::kTooClose};
    for (std::size_t i = 0; i < scan.size(); ++i) EXPECT_EQ(scan.kind(i), expected[i]) << i;
  }
}

// Drivers that do not know how far their scanner sees leave it 0.
TEST(Scan, WithoutAReachIsReadAsFarAsAnyScannerSees) {
  for (const float range_max : {0.0F, -1.0F, -kInf, kNan, kInf, 5000.0F}) {
    Scan scan = quarter_turns({5.0F, 900.0F, 1000.0F, kInf});
    scan.range_max_m = range_max;
    const BeamKind expected[] = {BeamKind::kHit, BeamKind::kHit, BeamKind::kNoReturn,
                                 BeamKind::kNoReturn};
    for (std::size_t i = 0; i < scan.size(); ++i) EXPECT_EQ(scan.kind(i), expected[i]) << range_max;
    EXPECT_FALSE(tells_reach(range_max)) << range_max;
  }
  EXPECT_TRUE(tells_reach(30.0F));
}

TEST(PosedScan, PlacesTheLaserByItsMounting) {
  PosedScan posed;
  posed.map_from_robot = {1.0, 2.0, std::numbers::pi / 2.0};
  posed.scan.robot_from_laser = {0.25, 0.0, 0.1};
  const Pose2 laser = posed.map_from_laser();
  EXPECT_NEAR(laser.x, 1.0, 1e-12);
  EXPECT_NEAR(laser.y, 2.25, 1e-12);
  EXPECT_NEAR(laser.theta, std::numbers::pi / 2.0 + 0.1, 1e-12);
}

TEST(Endpoints, HoldTheHitsInTheRobotFrame) {
  Scan scan = quarter_turns({1.0F, kInf, 2.0F, kNan});
  scan.robot_from_laser = {0.5, 0.25, std::numbers::pi / 2.0};
  const Endpoints points = endpoints_in_robot(scan);
  ASSERT_EQ(points.size(), 2U);
  EXPECT_EQ(points.beam, (std::vector<std::uint32_t>{0, 2}));
  EXPECT_NEAR(points.x_m[0], 0.5, 1e-6);
  EXPECT_NEAR(points.y_m[0], 1.25, 1e-6);
  EXPECT_NEAR(points.x_m[1], 0.5, 1e-6);
  EXPECT_NEAR(points.y_m[1], -1.75, 1e-6);
}

TEST(Endpoints, SubsampledOnesAreSpreadOverTheScan) {
  const Scan scan = quarter_turns(std::vector<float>(100, 1.0F));
  const Endpoints all = endpoints_in_robot(scan);
  EXPECT_EQ(subsample(all, 0).size(), 100U);
  EXPECT_EQ(subsample(all, 200).size(), 100U);
  const Endpoints some = subsample(all, 33);
  ASSERT_EQ(some.size(), 33U);
  for (std::size_t i = 1; i < some.size(); ++i) {
    EXPECT_GE(some.beam[i] - some.beam[i - 1], 3U);
    EXPECT_LE(some.beam[i] - some.beam[i - 1], 4U);
  }
}

}  // namespace
}  // namespace strata
