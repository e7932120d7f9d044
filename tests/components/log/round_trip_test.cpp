// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "components/log/carmen.hpp"
#include "components/log/log_writer.hpp"
#include "core/base/error.hpp"
#include "tests/components/log/log_fixture.hpp"
#include "tests/support/test_data.hpp"

namespace strata::log {
namespace {

using test_log::make_log;
using test_log::same_bits;

void expect_same_scans(const LogContent& a, const LogContent& b) {
  ASSERT_EQ(a.observations.size(), b.observations.size());
  for (std::size_t i = 0; i < a.observations.size(); ++i) {
    const Scan& x = a.observations[i].scan;
    const Scan& y = b.observations[i].scan;
    ASSERT_EQ(x.stamp, y.stamp) << i;
    ASSERT_TRUE(same_bits(x.ranges_m, y.ranges_m)) << i;
    ASSERT_EQ(x.angle_min_rad, y.angle_min_rad);
    ASSERT_EQ(x.angle_increment_rad, y.angle_increment_rad);
    ASSERT_EQ(x.range_max_m, y.range_max_m);
    ASSERT_NEAR(translation_distance(x.robot_from_laser, y.robot_from_laser), 0.0, 1e-9);
    // A heading goes through a quaternion; x and y keep their bits.
    ASSERT_EQ(a.observations[i].odom_from_robot.x, b.observations[i].odom_from_robot.x);
    ASSERT_EQ(a.observations[i].odom_from_robot.y, b.observations[i].odom_from_robot.y);
    ASSERT_NEAR(a.observations[i].odom_from_robot.theta, b.observations[i].odom_from_robot.theta,
                1e-14);
  }
}

class RoundTrip : public ::testing::Test {
 protected:
  LogContent through_bag(const LogContent& log, BagStorage storage, BagCompression compression) {
    const auto path = folder_.path() / ("bag" + std::to_string(count_++));
    write_bag(path, log, storage, compression);
    return read_log(path);
  }
  LogContent through_carmen(const LogContent& log) {
    const auto path = folder_.path() / ("log" + std::to_string(count_++) + ".clf");
    write_carmen(path, log);
    return read_log(path);
  }
  strata::test::TemporaryDirectory folder_;
  int count_ = 0;
};

TEST_F(RoundTrip, CarmenToBagToCarmenKeepsScansBitForBit) {
  const LogContent original = through_carmen(make_log(50, 180, 1));
  for (const auto compression :
       {BagCompression::kNone, BagCompression::kZstd, BagCompression::kLz4}) {
    const LogContent bag = through_bag(original, BagStorage::kMcap, compression);
    expect_same_scans(original, bag);
    expect_same_scans(original, through_carmen(bag));
  }
  const LogContent bag = through_bag(original, BagStorage::kSqlite3, BagCompression::kNone);
  expect_same_scans(original, bag);
  expect_same_scans(original, through_carmen(bag));
}

TEST_F(RoundTrip, AScannerThatIsNoSickGoesThroughCarmenToo) {
  LogContent log = make_log(5, 720, 2);
  for (Observation& observation : log.observations) {
    observation.scan.angle_min_rad = -3.124F;
    observation.scan.angle_increment_rad = 0.00871F;
    observation.scan.range_max_m = 12.0F;
    observation.scan.robot_from_laser = {0.0, 0.0, 1.57};
  }
  expect_same_scans(log, through_carmen(log));
}

TEST_F(RoundTrip, OdometryBetweenScansSurvives) {
  const LogContent log = make_log(10, 8, 3);
  EXPECT_EQ(through_carmen(log).odometry.size(), log.odometry.size());
  // In a bag the scans' own odometry joins them; back in CARMEN it is in the scan lines again.
  const LogContent bag = through_bag(log, BagStorage::kMcap, BagCompression::kZstd);
  EXPECT_EQ(bag.odometry.size(), log.odometry.size() + log.observations.size());
  EXPECT_EQ(through_carmen(bag).odometry.size(), log.odometry.size());
}

TEST_F(RoundTrip, NothingIsLeftOfABagThatCannotBePut) {
  const auto path = folder_.path() / "full";
  std::filesystem::create_directory(path);
  test_log::write_text(path / "mine.txt", "mine");
  EXPECT_THROW(write_bag(path, make_log(2, 4, 4), BagStorage::kMcap), OutputError);
  EXPECT_EQ(test::bytes_of(path / "mine.txt"), "mine");
  EXPECT_THROW(write_carmen(folder_.path() / "no" / "such.clf", make_log(2, 4, 4)), OutputError);
  std::size_t entries = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
    ++entries;
  }
  EXPECT_EQ(entries, 1U);
}

}  // namespace
}  // namespace strata::log
