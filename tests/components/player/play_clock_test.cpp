// SPDX-License-Identifier: Apache-2.0
#include "components/player/play_clock.hpp"

#include <chrono>
#include <cstdint>
#include <limits>

#include <gtest/gtest.h>

#include "components/player/source.hpp"

namespace strata::player {
namespace {

using std::chrono::hours;
using std::chrono::seconds;

constexpr Duration kSecond{1'000'000'000};
const PlayClock::Time kBegin{hours(24 * 365)};

PlayClock running(double rate) {
  PlayClock clock;
  clock.set_rate(rate, kBegin);
  clock.run(true, kBegin);
  return clock;
}

TEST(PlayClock, GoesAsFastAsItsRateAndStandsUntilItRuns) {
  PlayClock clock;
  clock.set_rate(4.0, kBegin);
  clock.jump(kSecond, kBegin);
  EXPECT_EQ(clock.position(kBegin + hours(1)), kSecond);
  clock.run(true, kBegin + hours(1));
  EXPECT_EQ(clock.position(kBegin + hours(1) + seconds(1)).ns, 5 * kSecond.ns);
  clock.set_rate(2.0, kBegin + hours(1) + seconds(1));
  EXPECT_EQ(clock.position(kBegin + hours(1) + seconds(2)).ns, 7 * kSecond.ns);
  clock.run(false, kBegin + hours(1) + seconds(2));
  EXPECT_EQ(clock.position(kBegin + hours(9)).ns, 7 * kSecond.ns);
}

TEST(PlayClock, WaitsAsLongAsTheRateSays) {
  EXPECT_EQ(running(4.0).wait({8 * kSecond.ns}, kBegin), seconds(2) + std::chrono::nanoseconds(1));
  EXPECT_EQ(running(4.0).wait({8 * kSecond.ns}, kBegin + seconds(2)).count(), 0);
  EXPECT_EQ(running(4.0).wait({8 * kSecond.ns}, kBegin + seconds(3)).count(), 0);
}

TEST(PlayClock, StaysAtTheLongestPlaceHoweverFastAndHoweverLong) {
  for (const double rate : {1e6, 1e9, 1e300, std::numeric_limits<double>::infinity()}) {
    PlayClock clock = running(rate);
    for (int day = 1; day < 20; ++day) {
      const PlayClock::Time now = kBegin + hours(24 * day);
      EXPECT_EQ(clock.position(now), PlayClock::kLongest) << rate;
      clock.run(true, now);  // goes on from there
    }
  }
  PlayClock clock = running(1.0);
  clock.jump({std::numeric_limits<std::int64_t>::max()}, kBegin);
  EXPECT_EQ(clock.position(kBegin + seconds(1)), PlayClock::kLongest);
}

TEST(PlayClock, WaitsNeverLongerThanAClockCanAdd) {
  for (const double rate : {1e-3, 1e-9, 1e-300, 1.0}) {
    for (const Duration place : {PlayClock::kLongest, Duration{2'000'000'000 * kSecond.ns}}) {
      EXPECT_EQ(running(rate).wait(place, kBegin), PlayClock::kLongestWait) << rate;
    }
  }
}

TEST(PlayClock, SaysTheSamePlaceForATimeBeforeIt) {
  EXPECT_EQ(running(1e6).position(kBegin - seconds(1)), Duration{});
}

TEST(Since, SaysHowFarApartStampsAreHoweverFar) {
  constexpr auto kFirst = std::numeric_limits<std::int64_t>::min();
  constexpr auto kLast = std::numeric_limits<std::int64_t>::max();
  EXPECT_EQ(since({5}, {12}), Duration{7});
  EXPECT_EQ(since({12}, {5}), Duration{-7});
  EXPECT_EQ(since({kFirst}, {kLast}), Duration{kLast});
  EXPECT_EQ(since({kLast}, {kFirst}), Duration{-kLast});
}

}  // namespace
}  // namespace strata::player
