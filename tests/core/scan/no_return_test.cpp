// SPDX-License-Identifier: Apache-2.0
#include "core/scan/no_return.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/random/stream.hpp"

namespace strata {
namespace {

using ::testing::FloatEq;
using ::testing::SizeIs;

/// A drive along a corridor; `code` says what the scanner sends for what is further than `reach_m`.
class NoReturn : public ::testing::Test {
 protected:
  static constexpr std::size_t kBeams = 90;
  void drive(double reach_m, const std::function<float()>& code, double step_m = 0.2,
             double turn_rad = 0.6) {
    for (int i = 0; i < 200; ++i) {
      const double x_m = step_m * i;
      const double heading = turn_rad * std::sin(0.1 * i);
      Scan scan;
      scan.range_max_m = 80.0F;
      for (std::size_t beam = 0; beam < kBeams; ++beam) {
        const double bearing = (static_cast<double>(beam) - 44.5) * 0.022 + heading;
        const double side_m = 1.3 / std::max(0.001, std::abs(std::sin(bearing)));
        const double end_m = (60.0 - x_m) / std::cos(bearing);
        const double range_m = std::min(side_m, end_m) + random_.normal(0.0, 0.01);
        const double rounded_m = std::round(range_m * 100.0) / 100.0;
        scan.ranges_m.push_back(range_m < reach_m ? static_cast<float>(rounded_m) : code());
      }
      scans_.push_back(scan);
      poses_.push_back({x_m, 0.0, heading});
    }
  }
  void add(float range_m, std::size_t scan = 0) { scans_.at(scan).ranges_m.push_back(range_m); }
  [[nodiscard]] std::vector<NoReturnCode> find() const {
    std::vector<PlacedScan> placed;
    for (std::size_t i = 0; i < scans_.size(); ++i) placed.push_back({&scans_[i], poses_[i]});
    return find_no_return_codes(placed);
  }
  std::vector<Scan> scans_;
  std::vector<Pose2> poses_;
  RandomStream random_{7, StreamId::kTest};
};

TEST_F(NoReturn, IsNotFoundWhereEveryBeamHitsAWall) {
  drive(1e9, nullptr);
  EXPECT_THAT(find(), SizeIs(0));
}

TEST_F(NoReturn, IsNotFoundWhereTheLogHasNoneButInfinity) {
  drive(20.0, [] { return std::numeric_limits<float>::infinity(); });
  EXPECT_THAT(find(), SizeIs(0));
}

TEST_F(NoReturn, IsTheScannersReachWhereThatIsSent) {
  for (const float reach_m : {4.0F, 8.0F, 12.5F}) {
    scans_.clear();
    poses_.clear();
    drive(static_cast<double>(reach_m), [=] { return reach_m; });
    const auto codes = find();
    ASSERT_THAT(codes, SizeIs(1)) << reach_m;
    EXPECT_THAT(codes[0].from_m, FloatEq(reach_m));
    EXPECT_THAT(codes[0].to_m, FloatEq(reach_m));
  }
}

TEST_F(NoReturn, MayScatter) {
  drive(20.0, [this] {
    const double code_m = 51.1 + std::clamp(random_.normal(0.0, 0.02), -0.05, 0.06);
    return static_cast<float>(std::round(code_m * 100.0) / 100.0);
  });
  const auto codes = find();
  ASSERT_THAT(codes, SizeIs(1));
  EXPECT_GE(codes[0].from_m, 51.0F);
  EXPECT_LE(codes[0].from_m, 51.06F);
  std::size_t sent = 0;
  for (const Scan& scan : scans_) {
    sent += static_cast<std::size_t>(
        std::count_if(scan.ranges_m.begin(), scan.ranges_m.end(), [](float r) { return r > 30; }));
  }
  EXPECT_EQ(codes[0].readings, sent);
}

TEST_F(NoReturn, MayHaveAnOutlierAboveIt) {
  drive(20.0, [] { return 50.0F; });
  add(63.2F);
  const auto codes = find();
  ASSERT_THAT(codes, SizeIs(1));
  EXPECT_THAT(codes[0].from_m, FloatEq(50.0F));
}

TEST_F(NoReturn, MayBeTwoCodes) {
  drive(20.0, [this] { return random_.uniform() < 0.1 ? 50.0F : 51.15F; });
  const auto codes = find();
  ASSERT_THAT(codes, SizeIs(2));
  EXPECT_THAT(codes[0].from_m, FloatEq(51.15F));
  EXPECT_THAT(codes[1].from_m, FloatEq(50.0F));
}

TEST_F(NoReturn, MayBeRare) {
  drive(20.0, [this] {
    return random_.uniform() < 0.05 ? 30.0F : std::numeric_limits<float>::quiet_NaN();
  });
  EXPECT_THAT(find(), SizeIs(1));
}

TEST_F(NoReturn, IsNotAWallBeforeWhichTheRobotStood) {
  drive(1e9, nullptr);
  for (int i = 0; i < 500; ++i) {  // 500 more scans from the beginning of the hall
    scans_.push_back(scans_.front());
    poses_.push_back(poses_.front());
    for (float& range : scans_.back().ranges_m) {
      range = std::round(100.0F * (range + static_cast<float>(random_.normal(0.0, 0.01)))) / 100.0F;
    }
  }
  EXPECT_THAT(find(), SizeIs(0));
}

TEST_F(NoReturn, IsNotAWallAlongWhichTheRobotDrives) {
  drive(
      20.0, [] { return std::numeric_limits<float>::infinity(); }, 0.2, 0.0);
  EXPECT_THAT(find(), SizeIs(0));
}

// As in a log of whose every scan the last beam reads 50.
TEST_F(NoReturn, MayBeWhatOneBeamAlwaysSends) {
  drive(20.0, [] { return std::numeric_limits<float>::infinity(); });
  for (std::size_t i = 0; i < scans_.size(); ++i) {
    add(50.0F, i);
    poses_[i].theta = 0.05 * static_cast<double>(i);
  }
  EXPECT_THAT(find(), SizeIs(1));
}

// Four beams, each a quarter of the scanner.
TEST_F(NoReturn, IsNotAWallAlongWhichAScannerOfFewBeamsDrives) {
  for (int i = 0; i < 100; ++i) {
    Scan scan;
    scan.range_max_m = 80.0F;
    scan.ranges_m = {1.5F, 3.0F, 4.5F, std::numeric_limits<float>::infinity()};
    scans_.push_back(scan);
    poses_.push_back({0.2 * i, 0.0, 0.0});
  }
  EXPECT_THAT(find(), SizeIs(0));
}

TEST_F(NoReturn, OfARobotThatStandsIsSeenInManyDirections) {
  drive(
      40.0, [] { return 50.0F; }, 0.0, 0.0);
  EXPECT_THAT(find(), SizeIs(0)) << "a few beams of ninety may be a wall";
  scans_.clear();
  poses_.clear();
  drive(
      4.0, [] { return 50.0F; }, 0.0, 0.0);
  EXPECT_THAT(find(), SizeIs(1));
}

TEST_F(NoReturn, OfScansWithoutAnyReadingIsNothing) {
  EXPECT_THAT(find(), SizeIs(0));
  scans_.emplace_back();
  poses_.emplace_back();
  EXPECT_THAT(find(), SizeIs(0));
  add(0.0F);
  add(std::numeric_limits<float>::quiet_NaN());
  add(1e30F);
  EXPECT_THAT(find(), SizeIs(0));
}

TEST(RangeLimit, OfAScanTurnsWhatLiesBehindItIntoInfinity) {
  Scan scan;
  scan.range_max_m = 30.0F;
  scan.ranges_m = {5.0F, 12.0F, 29.0F, 0.0F, std::numeric_limits<float>::quiet_NaN()};
  set_range_limit(scan, 12.0F);
  EXPECT_EQ(scan.range_max_m, 12.0F);
  EXPECT_EQ(scan.ranges_m[0], 5.0F);
  EXPECT_TRUE(std::isinf(scan.ranges_m[1]));
  EXPECT_TRUE(std::isinf(scan.ranges_m[2]));
  EXPECT_EQ(scan.ranges_m[3], 0.0F);
  EXPECT_TRUE(std::isnan(scan.ranges_m[4]));
}

}  // namespace
}  // namespace strata
