// SPDX-License-Identifier: Apache-2.0
/// Doors that follow the time of day and week, and doors that do not.
#include "core/patch/chain_in_time.hpp"

#include <cmath>
#include <functional>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "core/random/stream.hpp"

namespace strata::patch {
namespace {

constexpr double kHour_s = 3600.0;
constexpr double kDay_s = 24.0 * kHour_s;

using Share = std::function<double(double)>;  // open, by the time in seconds

double hour_of_day(double t_s) { return std::fmod(t_s, kDay_s) / kHour_s; }
double office_hours(double t_s) {
  const double hour = hour_of_day(t_s);
  return hour >= 8.0 && hour < 17.0 ? 0.95 : 0.05;
}
double working_days(double t_s) {
  return std::fmod(t_s / kDay_s, 7.0) < 5.0 ? office_hours(t_s) : 0.05;
}

struct Look {
  double t_s = 0.0;
  bool is_open = false;
  bool is_first_of_day = false;
};

/// A robot that passes a door at odd times from 7 to 21 h every day; the door is drawn anew at a
/// rate, open with the share of that time.
std::vector<Look> passes(const Share& share, double rate_per_s, int days, std::uint64_t seed) {
  RandomStream random(seed, StreamId::kTest);
  std::vector<Look> looks;
  double drawn_until_s = 0.0;
  bool is_open = random.bernoulli(share(0.0));
  double next_draw_s = random.exponential(rate_per_s);
  for (int day = 0; day < days; ++day) {
    bool is_first = true;
    for (double hour = 7.0 + random.uniform(); hour < 21.0; hour += random.uniform(0.2, 1.5)) {
      const double t_s = kDay_s * day + kHour_s * hour;
      for (; next_draw_s < t_s; next_draw_s += random.exponential(rate_per_s)) {
        is_open = random.bernoulli(share(next_draw_s));
      }
      drawn_until_s = t_s;
      looks.push_back({drawn_until_s, is_open, is_first});
      is_first = false;
    }
  }
  return looks;
}

struct Known {
  std::vector<std::vector<double>> memberships;
  SequenceHistory history;
  Chain chain;
  std::optional<ChainInTime> in_time;
};

Known learned(const std::vector<Look>& looks, double until_s, const ChainConfig& config = {}) {
  Known known;
  double before_s = 0.0;
  for (const Look& look : looks) {
    if (look.t_s >= until_s) break;
    known.history.append(known.memberships.empty() ? 0.0 : look.t_s - before_s,
                         Stamp::from_seconds(look.t_s));
    known.memberships.push_back({look.is_open ? 0.0 : 1.0, look.is_open ? 1.0 : 0.0});
    before_s = look.t_s;
  }
  known.chain = learn_chain(known.memberships, known.history, config);
  known.in_time = learn_chain_in_time(known.memberships, known.history, known.chain, config);
  return known;
}

/// Mean squared error of what is foretold of the first look of each day from then on.
struct Brier {
  double in_time = 0.0;
  double constant = 0.0;
};
Brier brier_of_mornings(const Known& known, const std::vector<Look>& looks, double from_s) {
  Brier brier;
  int count = 0;
  std::vector<double> shares(2);
  for (std::size_t i = 1; i < looks.size(); ++i) {
    if (looks[i].t_s < from_s || !looks[i].is_first_of_day) continue;
    const double dt_s = looks[i].t_s - looks[i - 1].t_s;
    const auto foretold = [&](double rate_per_s, double usual) {
      const double kept = std::exp(-rate_per_s * dt_s);
      return kept * (looks[i - 1].is_open ? 1.0 : 0.0) + (1.0 - kept) * usual;
    };
    const double truth = looks[i].is_open ? 1.0 : 0.0;
    const double constant = foretold(known.chain.rate_per_s, known.chain.usual[1]);
    double in_time = constant;
    if (known.in_time) {
      periodic::shares_at(known.in_time->usual,
                          periodic::part_of_week(Stamp::from_seconds(looks[i].t_s)), shares);
      in_time = foretold(known.in_time->rate_per_s, shares[1]);
    }
    brier.constant += (constant - truth) * (constant - truth);
    brier.in_time += (in_time - truth) * (in_time - truth);
    ++count;
  }
  brier.constant /= count;
  brier.in_time /= count;
  return brier;
}

TEST(ChainInTime, ForetellsTheMorningOfADoorOfOfficeHours) {
  Brier mean;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    for (const Share& share : {Share(office_hours), Share(working_days)}) {
      const std::vector<Look> looks = passes(share, 1.0 / kHour_s, 60, seed);
      const Known known = learned(looks, 30.0 * kDay_s);
      ASSERT_TRUE(known.in_time) << seed;
      const Brier brier = brier_of_mornings(known, looks, 30.0 * kDay_s);
      mean.in_time += 0.1 * brier.in_time;
      mean.constant += 0.1 * brier.constant;
    }
  }
  EXPECT_LE(mean.in_time, 0.10);
  EXPECT_GE(mean.constant, 0.15) << "or it is no feat";
}

// Three hours pass until half of a change of hours shows: what stands there says less of what is
// usual now than what was drawn does.
TEST(ChainInTime, HasTheSharesOfDrawsAlsoOfADoorThatLags) {
  const std::vector<Look> looks = passes(office_hours, 1.0 / (3.0 * kHour_s), 150, 6);
  double open = 0.0;
  double count = 0.0;
  for (const Look& look : looks) {
    if (std::abs(hour_of_day(look.t_s) - 10.0) > 0.5) continue;
    open += look.is_open ? 1.0 : 0.0;
    count += 1.0;
  }
  EXPECT_LT(open / count, 0.65) << "it lags";
  const Known known = learned(looks, 150.0 * kDay_s);
  ASSERT_TRUE(known.in_time);
  std::vector<double> shares(2);
  periodic::shares_at(known.in_time->usual, 10.0 / 168.0, shares);
  EXPECT_GT(shares[1], 0.8);
}

TEST(ChainInTime, IsOfTheWeekWhereWeekendsDiffer) {
  const std::vector<Look> looks = passes(working_days, 1.0 / kHour_s, 42, 3);
  const Known known = learned(looks, 42.0 * kDay_s);
  ASSERT_TRUE(known.in_time);
  const auto open_at = [&](double day, double hour) {
    std::vector<double> shares(2);
    periodic::shares_at(known.in_time->usual,
                        periodic::part_of_week(Stamp::from_seconds(kDay_s * day + kHour_s * hour)),
                        shares);
    return shares[1];
  };
  EXPECT_GT(open_at(2.0, 12.0), 0.8);
  EXPECT_LT(open_at(2.0, 20.0), 0.3);
  EXPECT_LT(open_at(5.5, 0.0), 0.3);
  EXPECT_LT(open_at(6.0, 11.0), 0.4) << "a Sunday's noon";
}

TEST(ChainInTime, IsNoneOfDoorsThatMoveAtRandom) {
  int found = 0;
  int tried = 0;
  for (const double rate_per_s : {1.0 / 600.0, 1.0 / 7200.0, 1.0 / kDay_s, 1.0 / (3.0 * kDay_s)}) {
    for (const double open : {0.5, 0.1}) {
      for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        const std::vector<Look> looks =
            passes([&](double) { return open; }, rate_per_s, 25, 100 + seed);
        found += learned(looks, 25.0 * kDay_s).in_time ? 1 : 0;
        ++tried;
      }
    }
  }
  EXPECT_EQ(tried, 40);
  EXPECT_LE(found, 1);
}

TEST(ChainInTime, IsNoneWhereOnlyTheRateThatWasGivenIsOff) {
  const std::vector<Look> looks = passes([](double) { return 0.5; }, 1.0 / 7200.0, 25, 101);
  Known known = learned(looks, 25.0 * kDay_s);
  ASSERT_FALSE(known.in_time);
  known.chain.rate_per_s *= 20.0;
  EXPECT_FALSE(learn_chain_in_time(known.memberships, known.history, known.chain, {}));
}

TEST(ChainInTime, WaitsForDaysAndWeeks) {
  const std::vector<Look> looks = passes(office_hours, 1.0 / 600.0, 30, 4);
  EXPECT_FALSE(learned(looks, 6.0 * kDay_s).in_time) << "six days";
  const Known eight = learned(looks, 8.0 * kDay_s);
  ASSERT_TRUE(eight.in_time);
  for (const periodic::Harmonic& wave : eight.in_time->usual.harmonics) {
    EXPECT_EQ(wave.cycles_a_week % 7, 0) << "of the week after one";
  }
  EXPECT_FALSE(learned(looks, 30.0 * kDay_s, {.max_harmonics = 0}).in_time);
}

TEST(ChainInTime, OfSequencesThatWerePooledIsAsBefore) {
  const std::vector<Look> looks = passes(office_hours, 1.0 / kHour_s, 30, 5);
  Known known = learned(looks, 30.0 * kDay_s);
  ASSERT_TRUE(known.in_time);
  std::vector<std::vector<double>> memberships = known.memberships;
  SequenceHistory pooled = known.history;
  while (memberships.size() > 12) {
    std::size_t second = 1;
    while (memberships[second] != memberships[0]) ++second;
    pooled.pool(0, second);
    memberships.erase(memberships.begin());
  }
  const auto again = learn_chain_in_time(memberships, pooled, known.chain, {});
  ASSERT_TRUE(again);
  EXPECT_NEAR(again->rate_per_s / known.in_time->rate_per_s, 1.0, 0.02);
  std::vector<double> expected(2);
  std::vector<double> got(2);
  for (int hour = 0; hour < periodic::kHoursAWeek; ++hour) {
    periodic::shares_at(known.in_time->usual, hour / 168.0, expected);
    periodic::shares_at(again->usual, hour / 168.0, got);
    EXPECT_NEAR(got[1], expected[1], 0.02) << hour;
  }
}

TEST(ChainInTime, IsNoneOfNothing) {
  const Chain chain{1e-3, {0.5, 0.5}};
  EXPECT_FALSE(learn_chain_in_time({}, {}, chain, {}));
  EXPECT_FALSE(learn_chain_in_time({}, {}, {1e-3, {1.0}}, {})) << "one configuration";
}

}  // namespace
}  // namespace strata::patch
