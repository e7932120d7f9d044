// SPDX-License-Identifier: Apache-2.0
#include "core/periodic/periodic_shares.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

namespace strata::periodic {
namespace {

constexpr double kDay_s = 86400.0;

TEST(TimeOfWeek, ComesAgainEverySevenDaysAlsoBeforeTheEpoch) {
  for (const double week : {-3.0, -1.0, 0.0, 1.0, 2900.0}) {
    const Stamp stamp = Stamp::from_seconds(7.0 * kDay_s * week + 2.0 * kDay_s + 5.5 * 3600.0);
    EXPECT_NEAR(part_of_week(stamp), (2.0 * 24.0 + 5.5) / 168.0, 1e-12) << week;
    EXPECT_EQ(hour_of_week(stamp), 53) << week;
    EXPECT_EQ(day_of(stamp), static_cast<std::int64_t>(7.0 * week) + 2) << week;
    EXPECT_EQ(week_of_day(day_of(stamp)), static_cast<std::int64_t>(week)) << week;
  }
  EXPECT_EQ(hour_of_week(Stamp{-1}), 167);
  EXPECT_LT(part_of_week(Stamp{-1}), 1.0);
}

TEST(PeriodicShares, AreThoseOfTheirLogitsWithoutWaves) {
  const PeriodicShares constant{{std::log(0.2), std::log(0.5), std::log(0.3)}, {}};
  EXPECT_FALSE(constant.is_periodic());
  std::array<double, 3> shares{};
  for (const double part : {0.0, 0.3, 0.99}) {
    shares_at(constant, part, shares);
    EXPECT_NEAR(shares[0], 0.2, 1e-12);
    EXPECT_NEAR(shares[1], 0.5, 1e-12);
    EXPECT_NEAR(shares[2], 0.3, 1e-12);
  }
}

TEST(PeriodicShares, FollowTheirWaves) {
  const PeriodicShares door{{0.0, 0.0}, {{7, {0.0, 2.0}, {0.0, 0.0}}, {1, {0.0, 0.0}, {0.0, 1.0}}}};
  std::array<double, 2> shares{};
  for (int hour = 0; hour < kHoursAWeek; ++hour) {
    const double part = hour / 168.0;
    const double logit = 2.0 * std::cos(2.0 * std::numbers::pi * 7.0 * part) +
                         std::sin(2.0 * std::numbers::pi * part);
    shares_at(door, part, shares);
    EXPECT_NEAR(shares[1], 1.0 / (1.0 + std::exp(-logit)), 1e-12) << hour;
    EXPECT_NEAR(shares[0] + shares[1], 1.0, 1e-12) << hour;
  }
}

TEST(PeriodicShares, AreSoundWithAFiniteEntryAState) {
  const PeriodicShares sound{{0.0, 1.0}, {{7, {0.0, 1.0}, {0.0, 1.0}}}};
  EXPECT_TRUE(is_sound(sound));
  EXPECT_TRUE(is_sound({}));
  PeriodicShares damaged = sound;
  damaged.harmonics[0].sine.pop_back();
  EXPECT_FALSE(is_sound(damaged));
  damaged = sound;
  damaged.logit[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(is_sound(damaged));
  damaged = sound;
  damaged.harmonics[0].cycles_a_week = 0;
  EXPECT_FALSE(is_sound(damaged));
  EXPECT_FALSE(is_sound({{}, {{7, {}, {}}}})) << "waves of no state";
}

}  // namespace
}  // namespace strata::periodic
