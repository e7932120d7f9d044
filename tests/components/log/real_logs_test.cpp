// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "components/log/carmen.hpp"
#include "components/log/log_reader.hpp"
#include "components/log/log_writer.hpp"
#include "core/base/error.hpp"
#include "tests/components/log/log_fixture.hpp"
#include "tests/support/test_data.hpp"

namespace strata::log {
namespace {

using test_log::same_bits;

struct Expected {
  const char* path;
  std::size_t scans;
  std::size_t beams;
  double duration_s;
  double laser_ahead_m;
};

class RealLog : public ::testing::TestWithParam<Expected> {};

TEST_P(RealLog, HasTheScansItsDescriptionNames) {
  const Expected& expected = GetParam();
  STRATA_REQUIRE_DATA(path, expected.path);
  ReadReport report;
  const auto scans = read_observations(path, {}, &report);
  EXPECT_EQ(scans.size(), expected.scans);
  EXPECT_EQ(report.bad_lines, 0U) << report.first_bad;
  EXPECT_NEAR((scans.back().scan.stamp - scans.front().scan.stamp).seconds(), expected.duration_s,
              1.0);
  for (std::size_t i = 0; i < scans.size(); ++i) {
    ASSERT_EQ(scans[i].scan.size(), expected.beams);
    ASSERT_TRUE(scans[i].has_odometry);
    if (i > 0) {
      ASSERT_LE(scans[i - 1].scan.stamp, scans[i].scan.stamp);
    }
  }
  EXPECT_NEAR(scans.front().scan.robot_from_laser.x, expected.laser_ahead_m, 0.001);
}

INSTANTIATE_TEST_SUITE_P(
    All, RealLog,
    ::testing::Values(
        Expected{"wean_hall/run1.clf.gz", 713, 180, 134.8, 0.25},
        Expected{"wean_hall/run2.clf.gz", 2251, 180, 239.6, 0.25},
        Expected{"wean_hall/run3.clf.gz", 1241, 180, 132.3, 0.25},
        Expected{"wean_hall/ros2_run2/ros2_db3", 2251, 180, 239.6, 0.25},
        Expected{"wean_hall/ros2_run2/ros2_mcap_zstd", 2251, 180, 239.6, 0.25},
        Expected{"fr079/fr079.clf.gz", 4934, 360, 1061.4, -0.04},
        // The bag's tf_static says 0.04 m ahead where the log it was made from says behind.
        Expected{"fr079/ros2_mcap_zstd", 4934, 360, 1061.4, 0.04},
        Expected{"intel/intel.clf.gz", 13631, 180, 2691.3, 0.0},
        Expected{"fhw/fhw-corrected.log.gz", 488, 180, 2007.2, 0.0},
        Expected{"olin_mac/take_2_db3", 357, 720, 46.2, 0.004},
        Expected{"olin_mac/take_2_mcap_none", 357, 720, 46.2, 0.004},
        Expected{"olin_mac/take_2_mcap_zstd", 357, 720, 46.2, 0.004},
        Expected{"olin_mac/take_2_mcap_lz4", 357, 720, 46.2, 0.004}));

TEST(RealLogs, TheSamePayloadIsTheSameInEveryStorage) {
  STRATA_REQUIRE_DATA(reference_path, "olin_mac/take_2_db3");
  const auto reference = read_observations(reference_path);
  for (const char* other : {"take_2_mcap_none", "take_2_mcap_zstd", "take_2_mcap_lz4"}) {
    STRATA_REQUIRE_DATA(path, std::string("olin_mac/") + other);
    const auto scans = read_observations(path);
    ASSERT_EQ(scans.size(), reference.size());
    for (std::size_t i = 0; i < scans.size(); ++i) {
      ASSERT_EQ(scans[i].scan.stamp, reference[i].scan.stamp) << other << " " << i;
      ASSERT_TRUE(same_bits(scans[i].scan.ranges_m, reference[i].scan.ranges_m)) << other;
      ASSERT_EQ(scans[i].odom_from_robot, reference[i].odom_from_robot) << other;
    }
  }
}

// The driver publishes the beams of a clockwise scanner counter-clockwise and stamps the sweep at
// its end; undistorted as the messages say, every wall is double.
TEST(RealLogs, OlinsBeamsRunAgainstTheirStatedTime) {
  STRATA_REQUIRE_DATA(path, "olin_mac/take_2_db3");
  ReadReport report;
  ASSERT_EQ(read_observations(path, {}, &report).size(), 357U);
  EXPECT_TRUE(report.sweep.reversed);
  EXPECT_NEAR(report.sweep.delay_s, 0.17, 0.06);
  ASSERT_FALSE(report.warnings.empty());
  EXPECT_NE(report.warnings.back().find("opposite order of time"), std::string::npos);
}

TEST(RealLogs, WeanAsCarmenAndAsBagAreTheSameScans) {
  STRATA_REQUIRE_DATA(carmen, "wean_hall/run2.clf.gz");
  STRATA_REQUIRE_DATA(bag, "wean_hall/ros2_run2/ros2_db3");
  const auto a = read_observations(carmen);
  const auto b = read_observations(bag);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ((b[i].scan.stamp - a[i].scan.stamp).ns, 1'000'000'000'000'000'000) << i;
    ASSERT_NEAR(translation_distance(a[i].odom_from_robot, b[i].odom_from_robot), 0.0, 1e-9);
    for (std::size_t beam = 0; beam < 180; ++beam) {
      ASSERT_EQ(a[i].scan.kind(beam), b[i].scan.kind(beam));
      if (a[i].scan.kind(beam) == BeamKind::kHit) {
        ASSERT_EQ(a[i].scan.ranges_m[beam], b[i].scan.ranges_m[beam]);
      }
    }
  }
}

TEST(RealLogs, WeanThroughMcapAndBackIsTheSameLog) {
  STRATA_REQUIRE_DATA(path, "wean_hall/run1.clf.gz");
  const strata::test::TemporaryDirectory folder;
  const LogContent original = read_log(path);
  write_bag(folder.path() / "bag", original, BagStorage::kMcap, BagCompression::kZstd);
  write_carmen(folder.path() / "back.clf", read_log(folder.path() / "bag"));
  const LogContent back = read_log(folder.path() / "back.clf");
  ASSERT_EQ(back.observations.size(), original.observations.size());
  EXPECT_EQ(back.odometry.size(), original.odometry.size());
  for (std::size_t i = 0; i < back.observations.size(); ++i) {
    const Scan& a = original.observations[i].scan;
    const Scan& b = back.observations[i].scan;
    ASSERT_EQ(a.stamp, b.stamp);
    ASSERT_TRUE(same_bits(a.ranges_m, b.ranges_m));
    ASSERT_EQ(a.angle_min_rad, b.angle_min_rad);
    ASSERT_EQ(original.observations[i].odom_from_robot.x, back.observations[i].odom_from_robot.x);
  }
}

TEST(RealLogs, ThreeDimensionalLogsAreRefusedAsSuch) {
  for (const char* name : {"hallway_3d/hallway.log.gz", "octomap_3d/scan_node.log.gz"}) {
    STRATA_REQUIRE_DATA(path, name);
    try {
      (void)read_observations(path);
      FAIL() << name;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("3D"), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace strata::log
