// SPDX-License-Identifier: Apache-2.0
#include "components/log/odometry_clock.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "components/log/log_reader.hpp"
#include "components/log/log_writer.hpp"
#include "tests/support/test_data.hpp"

namespace strata::log {
namespace {

LogContent read_as_it_is(const std::filesystem::path& path) {
  ReadOptions options;
  options.odometry_lag_s = 0.0;
  return read_log(path, options);
}

/// The same log with every stamp of odometry so much later.
LogContent with_late_odometry(const LogContent& content, double lag_s) {
  LogContent late = content;
  for (Observation& observation : late.observations) {
    late.odometry.push_back({observation.scan.stamp, observation.odom_from_robot});
    observation.has_odometry = false;
  }
  for (OdometrySample& sample : late.odometry) {
    sample.stamp = sample.stamp + Duration::from_seconds(lag_s);
  }
  std::stable_sort(late.odometry.begin(), late.odometry.end(),
                   [](const auto& a, const auto& b) { return a.stamp < b.stamp; });
  return late;
}

class LateOdometry : public ::testing::TestWithParam<double> {};

TEST_P(LateOdometry, OfARealLogIsFoundAndTakenBack) {
  STRATA_REQUIRE_DATA(path, "wean_hall/run3.clf.gz");
  const LogContent original = read_as_it_is(path);
  const strata::test::TemporaryDirectory folder;
  write_bag(folder.path() / "bag", with_late_odometry(original, GetParam()), BagStorage::kSqlite3);
  ReadReport report;
  const LogContent back = read_log(folder.path() / "bag", {}, &report);
  ASSERT_TRUE(report.clock.lag_s);
  EXPECT_NEAR(*report.clock.lag_s, GetParam(), 0.005);
  ASSERT_TRUE(report.clock.corrected_s);
  ASSERT_FALSE(report.warnings.empty());
  EXPECT_NE(report.warnings.back().find("odometry's stamps"), std::string::npos);
  ASSERT_EQ(back.observations.size(), original.observations.size());
  double worst_m = 0.0;
  for (std::size_t i = 0; i < back.observations.size(); ++i) {
    ASSERT_EQ(back.observations[i].scan.stamp, original.observations[i].scan.stamp);
    worst_m = std::max(worst_m, translation_distance(back.observations[i].odom_from_robot,
                                                     original.observations[i].odom_from_robot));
  }
  EXPECT_LT(worst_m, 0.02);
}

INSTANTIATE_TEST_SUITE_P(EitherWay, LateOdometry, ::testing::Values(-0.7, -0.3, -0.1, 0.1, 0.64));

TEST(OdometryClock, OfALogByOneClockIsLeftAlone) {
  STRATA_REQUIRE_DATA(path, "wean_hall/run2.clf.gz");
  ReadReport report;
  const auto read = read_log(path, {}, &report);
  ASSERT_TRUE(report.clock.lag_s);
  EXPECT_NEAR(*report.clock.lag_s, 0.0, 0.01);
  EXPECT_FALSE(report.clock.corrected_s);
  const auto as_it_is = read_as_it_is(path);
  ASSERT_EQ(read.observations.size(), as_it_is.observations.size());
  for (std::size_t i = 0; i < read.observations.size(); ++i) {
    ASSERT_EQ(read.observations[i].odom_from_robot, as_it_is.observations[i].odom_from_robot);
  }
}

// Its map is folded by 6 m without.
TEST(OdometryClock, OfCsailIsASixthOfASecondEarly) {
  STRATA_REQUIRE_DATA(path, "csail/csail.clf.gz");
  ReadReport report;
  (void)read_log(path, {}, &report);
  ASSERT_TRUE(report.clock.corrected_s);
  EXPECT_NEAR(*report.clock.corrected_s, -0.17, 0.03);
}

TEST(OdometryClock, AsGivenIsNotAskedFor) {
  STRATA_REQUIRE_DATA(path, "wean_hall/run3.clf.gz");
  ReadOptions options;
  options.odometry_lag_s = 0.25;
  ReadReport report;
  const LogContent late = read_log(path, options, &report);
  EXPECT_TRUE(report.clock.is_given);
  EXPECT_EQ(report.clock.corrected_s, 0.25);
  const LogContent original = read_as_it_is(path);
  bool differs = false;
  for (std::size_t i = 0; i < late.observations.size(); ++i) {
    differs = differs ||
              !(late.observations[i].odom_from_robot == original.observations[i].odom_from_robot);
  }
  EXPECT_TRUE(differs);
  EXPECT_EQ((original.odometry.front().stamp - late.odometry.front().stamp).seconds(), 0.25);
}

TEST(OdometryClock, IsNotToldWithoutOdometry) {
  STRATA_REQUIRE_DATA(path, "wean_hall/run3.clf.gz");
  ReadOptions options;
  options.use_odometry = false;
  ReadReport report;
  (void)read_log(path, options, &report);
  EXPECT_FALSE(report.clock.lag_s);
}

}  // namespace
}  // namespace strata::log
