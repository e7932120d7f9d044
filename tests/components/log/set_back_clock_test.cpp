// SPDX-License-Identifier: Apache-2.0
#include "components/log/set_back_clock.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "components/log/carmen.hpp"
#include "components/log/log_reader.hpp"
#include "core/random/stream.hpp"
#include "tests/components/log/log_fixture.hpp"
#include "tests/support/test_data.hpp"

namespace strata::log {
namespace {

constexpr auto kNoneAlike = [](std::size_t, std::size_t) { return false; };

/// About five messages a second.
std::vector<Stamp> regular(std::size_t count, std::uint64_t seed) {
  RandomStream random(seed, StreamId::kTest);
  std::vector<Stamp> stamps;
  for (std::size_t i = 0; i < count; ++i) {
    stamps.push_back(
        Stamp::from_seconds(1000.0 + 0.2 * static_cast<double>(i) + random.uniform(-0.02, 0.02)));
  }
  return stamps;
}

TEST(SetBackClock, TimeGoesOnAsIfItHadNotBeen) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    RandomStream random(seed, StreamId::kTest, 7);
    const std::vector<Stamp> truth = regular(400, seed);
    // By seconds, minutes into what was recorded, or beyond all of it; twice.
    const double back_s = std::vector<double>{1.5, 5.0, 30.0, 3600.0}[seed % 4];
    const auto first = static_cast<std::size_t>(random.uniform(60.0, 150.0));
    const auto second = static_cast<std::size_t>(random.uniform(200.0, 350.0));
    std::vector<Stamp> stamps = truth;
    for (std::size_t i = first; i < stamps.size(); ++i) {
      stamps[i] = stamps[i] - Duration::from_seconds(i < second ? back_s : 2.0 * back_s);
    }
    const SetBackClock clock = mend_set_back_clock(stamps, kNoneAlike);
    EXPECT_EQ(clock.times, 2U);
    EXPECT_NEAR(clock.furthest_s, back_s, 0.3);
    EXPECT_NEAR(clock.first_s, (truth[first] - truth[0]).seconds(), 0.3);
    for (std::size_t i = 0; i < stamps.size(); ++i) {
      ASSERT_NEAR((stamps[i] - truth[i]).seconds(), 0.0, 0.1) << seed << " " << i;
    }
  }
}

TEST(SetBackClock, LateMessagesKeepTheirTime) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    RandomStream random(seed, StreamId::kTest, 8);
    std::vector<Stamp> stamps = regular(400, seed);
    // Each tenth comes up to eight seconds late; a whole second of them comes four seconds late.
    std::rotate(stamps.begin() + 100, stamps.begin() + 105, stamps.begin() + 125);
    for (std::size_t i = 200; i + 50 < stamps.size(); i += 10) {
      const auto from = stamps.begin() + static_cast<std::ptrdiff_t>(i);
      std::rotate(from, from + 1, from + static_cast<std::ptrdiff_t>(random.uniform(2.0, 40.0)));
    }
    const std::vector<Stamp> before = stamps;
    EXPECT_EQ(mend_set_back_clock(stamps, kNoneAlike).times, 0U);
    EXPECT_EQ(stamps, before);
  }
}

TEST(SetBackClock, ACopyOfWhatWasRecordedIsLeftToWhoSkipsCopies) {
  std::vector<Stamp> stamps = regular(100, 1);
  stamps.insert(stamps.end(), stamps.begin() + 40, stamps.begin() + 60);
  const std::vector<Stamp> before = stamps;
  EXPECT_EQ(
      mend_set_back_clock(stamps, [](std::size_t i, std::size_t j) { return i - 60 == j; }).times,
      0U);
  EXPECT_EQ(stamps, before);
}

TEST(SetBackClock, OfALogIsMendedAndSaid) {
  const strata::test::TemporaryDirectory folder;
  LogContent content = test_log::make_log(60, 20, 3);
  write_carmen(folder.path() / "clean.clf", content);
  const std::vector<Observation> clean = read_observations(folder.path() / "clean.clf");
  for (std::size_t i = 30; i < content.observations.size(); ++i) {
    Stamp& stamp = content.observations[i].scan.stamp;
    stamp = stamp - Duration::from_seconds(100.0);
  }
  content.odometry.clear();
  write_carmen(folder.path() / "back.clf", content);
  ReadReport report;
  const std::vector<Observation> mended =
      read_observations(folder.path() / "back.clf", {}, &report);
  ASSERT_EQ(report.warnings.size(), 1U);
  EXPECT_NE(report.warnings[0].find("the clock was set back 1 time, by "), std::string::npos);
  ASSERT_EQ(mended.size(), clean.size());
  for (std::size_t i = 0; i < clean.size(); ++i) {
    EXPECT_EQ(mended[i].scan.ranges_m, clean[i].scan.ranges_m);
    EXPECT_EQ(mended[i].odom_from_robot, clean[i].odom_from_robot);
  }
}

}  // namespace
}  // namespace strata::log
