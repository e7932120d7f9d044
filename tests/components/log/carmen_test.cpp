// SPDX-License-Identifier: Apache-2.0
#include "components/log/carmen.hpp"

#include <cmath>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/geometry/angle.hpp"
#include "tests/components/log/log_fixture.hpp"
#include "tests/support/test_data.hpp"

namespace strata::log {
namespace {

using test_log::write_text;

std::string flaser(const std::string& ranges, int beams, const std::string& stamp,
                   const std::string& laser = "1.25 2 0", const std::string& odom = "1 2 0") {
  return "FLASER " + std::to_string(beams) + " " + ranges + " " + laser + " " + odom + " " + stamp +
         " host " + stamp + "\n";
}

class Carmen : public ::testing::Test {
 protected:
  LogContent read(const std::string& text) {
    const auto path = folder_.path() / "log.clf";
    write_text(path, text);
    return read_log(path, ReadOptions{}, &report_);
  }
  strata::test::TemporaryDirectory folder_;
  ReadReport report_;
};

TEST_F(Carmen, ReadsScansOdometryAndMounting) {
  const auto log = read("# comment\nPARAM robot_frontlaser_offset 0.25 nohost 0\n" +
                        flaser("1 2 3 4", 4, "0.5") + "ODOM 1 2 0 0 0 0 0.6 host 0.6\n");
  ASSERT_EQ(log.observations.size(), 1U);
  const Observation& observation = log.observations[0];
  EXPECT_EQ(observation.scan.ranges_m, (std::vector<float>{1, 2, 3, 4}));
  EXPECT_EQ(observation.odom_from_robot, (Pose2{1, 2, 0}));
  EXPECT_EQ(observation.scan.robot_from_laser, (Pose2{0.25, 0, 0}));
  EXPECT_EQ(observation.scan.stamp.ns, 500000000);
  EXPECT_EQ(log.odometry.size(), 1U);
  EXPECT_EQ(report_.messages.at("PARAM"), 1U);
  EXPECT_EQ(report_.bad_lines, 0U);
}

TEST_F(Carmen, BeamsOfFlaserAreCentredOnStraightAhead) {
  std::string ranges = "1";
  for (int i = 1; i < 180; ++i) ranges += " 1";
  const auto even = read(flaser(ranges, 180, "1"));
  EXPECT_NEAR(radians_to_degrees(even.observations[0].scan.bearing_rad(0)), -89.5, 1e-5);
  EXPECT_NEAR(radians_to_degrees(even.observations[0].scan.bearing_rad(179)), 89.5, 1e-5);
  const auto odd = read(flaser(ranges + " 1", 181, "1"));
  EXPECT_NEAR(radians_to_degrees(odd.observations[0].scan.bearing_rad(0)), -90.0, 1e-5);
  EXPECT_NEAR(radians_to_degrees(odd.observations[0].scan.bearing_rad(180)), 90.0, 1e-5);
}

TEST_F(Carmen, ScannerCodesBecomeNoReturn) {
  const auto log = read(flaser("81.83 81.87 81.91 80.0 79.9", 5, "1"));
  const auto& ranges = log.observations[0].scan.ranges_m;
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(std::isinf(ranges[static_cast<std::size_t>(i)])) << i;
  EXPECT_EQ(ranges[4], 79.9F);
}

TEST_F(Carmen, ALargestReadingThatPilesUpIsACode) {
  std::string ranges;
  for (int i = 0; i < 30; ++i) ranges += "51.05 ";
  const auto log = read(flaser(ranges + "3 44", 32, "1"));
  const Scan& scan = log.observations[0].scan;
  EXPECT_TRUE(std::isinf(scan.ranges_m[0]));
  EXPECT_EQ(scan.ranges_m[31], 44.0F);
  EXPECT_EQ(scan.range_max_m, 51.05F);
  EXPECT_THAT(report_.warnings, ::testing::SizeIs(1));
}

TEST_F(Carmen, ALongRangeSeenOnceStaysAHit) {
  const auto log = read(flaser("51.05 3 44", 3, "1"));
  EXPECT_EQ(log.observations[0].scan.ranges_m[0], 51.05F);
}

TEST_F(Carmen, ScansAreSortedByTheirStamp) {
  const auto log = read(flaser("1 1", 2, "3") + flaser("2 2", 2, "1") + flaser("3 3", 2, "2"));
  ASSERT_EQ(log.observations.size(), 3U);
  EXPECT_EQ(log.observations[0].scan.ranges_m[0], 2.0F);
  EXPECT_EQ(log.observations[2].scan.ranges_m[0], 1.0F);
  EXPECT_EQ(report_.scans_out_of_order, 1U);
}

TEST_F(Carmen, ALineCutAnywhereIsCountedAndTheRestIsRead) {
  const std::string good = flaser("1 2 3 4", 4, "0.5");
  const std::string last = flaser("5 6 7 8", 4, "1.25");
  // Behind the host name everything that we use is there; before it, nothing may be guessed.
  for (std::size_t length = 1; length < last.find(" host"); ++length) {
    const auto log = read(good + last.substr(0, length));
    EXPECT_EQ(log.observations.size(), 1U) << last.substr(0, length);
    if (length > 7) {
      EXPECT_EQ(report_.bad_lines, 1U) << last.substr(0, length);
      EXPECT_THAT(report_.first_bad, ::testing::HasSubstr("log.clf:2"));
    }
  }
}

TEST_F(Carmen, ABadNumberNamesItsLine) {
  const auto log = read(flaser("1 2", 2, "1") + flaser("1 x", 2, "2") + flaser("1 2", 2, "3"));
  EXPECT_EQ(log.observations.size(), 2U);
  EXPECT_EQ(report_.bad_lines, 1U);
  EXPECT_THAT(report_.first_bad,
              ::testing::HasSubstr("log.clf:2: field 4, 'x', is no number that can be used"));
}

TEST_F(Carmen, ScansThatClaimTheSameMomentAreTold) {
  (void)read(flaser("1 2", 2, "1") + flaser("1 3", 2, "1") + flaser("1 4", 2, "2"));
  EXPECT_THAT(report_.warnings, ::testing::ElementsAre(::testing::StartsWith(
                                    "1 of 3 scans have the stamp of the one before")));
}

TEST_F(Carmen, WordsAreCountedApartUpToALimit) {
  std::string text = flaser("1 2", 2, "1");
  for (int i = 0; i < 5000; ++i) text += "WORD" + std::to_string(i) + " 1\n";
  (void)read(text);
  EXPECT_LT(report_.messages.size(), 1100U);
  std::size_t counted = 0;
  for (const auto& [name, count] : report_.messages) counted += count;
  EXPECT_EQ(counted, 5001U);
}

TEST_F(Carmen, AScanOfNaNsIsSkippedAndCounted) {
  const auto log = read(flaser("1 nan", 2, "1") + flaser("nan nan", 2, "2"));
  ASSERT_EQ(log.observations.size(), 1U);
  EXPECT_EQ(log.observations[0].scan.kind(1), BeamKind::kInvalid);
  EXPECT_EQ(report_.scans_without_beams, 1U);
}

TEST_F(Carmen, ALogOfNothingButNaNsSaysSo) {
  try {
    (void)read(flaser("nan nan", 2, "1") + flaser("nan nan", 2, "2"));
    FAIL() << "was read";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("none of its 2 readable scans"));
  }
}

TEST_F(Carmen, RobotLaserStatesItsGeometry) {
  const auto log = read(
      "ROBOTLASER1 0 -1.5 3.0 0.5 30 0.01 0 4 1 2 30.5 4 2 7 8 5.1 6 0 5 6 0 0 0 0.3 0.3 0 12.5 "
      "host 12.5\n");
  const Scan& scan = log.observations[0].scan;
  EXPECT_EQ(scan.angle_min_rad, -1.5F);
  EXPECT_EQ(scan.angle_increment_rad, 0.5F);
  EXPECT_TRUE(std::isinf(scan.ranges_m[2]));
  EXPECT_EQ(log.observations[0].odom_from_robot, (Pose2{5, 6, 0}));
  EXPECT_EQ(scan.stamp.ns, 12500000000);
  EXPECT_NEAR(scan.robot_from_laser.x, 0.1, 1e-9);
}

TEST_F(Carmen, ARobotLaserThatDoesNotKnowItsReachIsRead) {
  const auto log = read(
      "ROBOTLASER1 0 -1.5 3.0 0.5 0 0.01 0 4 1 2 30.5 4 2 7 8 5.1 6 0 5 6 0 0 0 0.3 0.3 0 12.5 "
      "host 12.5\n");
  const Scan& scan = log.observations[0].scan;
  for (std::size_t beam = 0; beam < 4; ++beam) EXPECT_EQ(scan.kind(beam), BeamKind::kHit) << beam;
}

TEST_F(Carmen, ACorrectedLogOverRawOdometryTakesTheMountingFromItsParameter) {
  const auto log =
      read("PARAM robot_frontlaser_offset 0.1 h 0\n" + flaser("1 2", 2, "1", "5 5 1", "0 0 0") +
           flaser("1 2", 2, "2", "7 3 2", "1 0 0") + flaser("1 2", 2, "3", "9 1 3", "2 0 0"));
  EXPECT_EQ(log.observations[0].scan.robot_from_laser, (Pose2{0.1, 0, 0}));
  EXPECT_EQ(report_.mounting_source, "PARAM robot_frontlaser_offset");
}

TEST_F(Carmen, WhatIsNoLaserLogIsRefused) {
  EXPECT_THROW(read("hello world\n"), InputError);
  EXPECT_THROW(read(""), InputError);
  EXPECT_THROW(read("ODOM 1 2 0 0 0 0 0.6 host 0.6\n"), InputError);
  try {
    read("NODE 0 0 0 0 0 0\n1 2 3\n");
    FAIL() << "a 3D log was read";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("3D"));
  }
}

TEST_F(Carmen, CutsAreSecondsFromTheFirstScan) {
  const auto path = folder_.path() / "log.clf";
  write_text(path, flaser("1 1", 2, "100") + flaser("2 2", 2, "101") + flaser("3 3", 2, "102"));
  ReadOptions options;
  options.from_s = 0.5;
  options.to_s = 1.5;
  const auto scans = read_observations(path, options);
  ASSERT_EQ(scans.size(), 1U);
  EXPECT_EQ(scans[0].scan.ranges_m[0], 2.0F);
  options.from_s = 10.0;
  options.to_s = 20.0;
  EXPECT_THROW(read_observations(path, options), InputError);
}

}  // namespace
}  // namespace strata::log
