// SPDX-License-Identifier: Apache-2.0
#include "core/patch/chain.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/random/stream.hpp"

namespace strata::patch {
namespace {

/// What visits saw of a place that is drawn anew from `usual` at a rate.
struct Visits {
  std::vector<std::vector<double>> looks;
  SequenceHistory history;
};

/// misread: how often another configuration is taken for the true one, as the looks say too.
Visits visits_of(const std::vector<double>& usual, double rate_per_s, double mean_gap_s, int count,
                 double misread, std::uint64_t seed) {
  RandomStream random(seed, StreamId::kTest);
  const auto draw = [&] {
    double left = random.uniform();
    std::size_t k = 0;
    while (k + 1 < usual.size() && (left -= usual[k]) >= 0.0) ++k;
    return k;
  };
  Visits visits;
  std::size_t state = draw();
  for (int i = 0; i < count; ++i) {
    const double dt_s = i == 0 ? 0.0 : random.exponential(1.0 / mean_gap_s);
    if (!random.bernoulli(std::exp(-rate_per_s * dt_s))) state = draw();
    visits.history.append(dt_s);
    std::vector<double> row(usual.size(), misread / static_cast<double>(usual.size() - 1));
    row[random.bernoulli(misread) ? (state + 1) % usual.size() : state] = 1.0 - misread;
    visits.looks.push_back(row);
  }
  return visits;
}

Chain chain_of(const Visits& visits, const ChainConfig& config = {}) {
  return learn_chain(visits.looks, visits.history, config);
}

// A door that is open 4% of the time and moves 6.25 times an hour was learned as 0.68 by a chain
// with even odds.
TEST(Chain, OfADoorThatIsMostlyClosedHasItsShareAndItsRate) {
  for (const double open : {0.043, 0.094}) {
    const double rate_per_s = 6.25 / 3600.0 / (2.0 * open * (1.0 - open));
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
      const Chain chain =
          chain_of(visits_of({1.0 - open, open}, rate_per_s, 1.0 / rate_per_s, 20000, 0.0, seed));
      EXPECT_NEAR(chain.usual[1] / open, 1.0, 0.2) << open << " " << seed;
      EXPECT_NEAR(chain.rate_per_s / rate_per_s, 1.0, 0.2) << open << " " << seed;
      const double changes_per_h = 7200.0 * chain.rate_per_s * chain.usual[0] * chain.usual[1];
      EXPECT_NEAR(changes_per_h / 6.25, 1.0, 0.2) << open << " " << seed;
    }
  }
}

/// The same visits with all but `most` pooled, the two oldest of the more frequent configuration
/// first, as the online learner does.
Visits pooled(const Visits& visits, std::size_t most) {
  Visits left;
  for (std::size_t i = 0; i < visits.looks.size(); ++i) {
    const std::vector<Transition>& transitions = visits.history.transitions();
    left.history.append(i == 0 ? 0.0 : transitions[i - 1].dt_s);
    left.looks.push_back(visits.looks[i]);
    if (left.looks.size() <= most) continue;
    const auto often = static_cast<std::size_t>(
        2 * std::count(left.looks.begin(), left.looks.end(), std::vector<double>{0.0, 1.0}) >
        static_cast<std::ptrdiff_t>(left.looks.size()));
    const auto is_often = [&](const std::vector<double>& look) { return look[often] > 0.5; };
    const auto a = std::find_if(left.looks.begin(), left.looks.end(), is_often);
    const auto b = std::find_if(a + 1, left.looks.end(), is_often);
    left.history.pool(static_cast<std::size_t>(a - left.looks.begin()),
                      static_cast<std::size_t>(b - left.looks.begin()));
    left.looks.erase(a);
  }
  return left;
}

// Pooled sequences counted as one, so that the shares of both went to 0.5. Chance alone takes the
// rates of 2,000 visits to a seldom open door a fifth off in one seed of three.
TEST(Chain, OfTwoThousandVisitsPooledToFortyIsThatOfAllOfThem) {
  for (const double open : {0.043, 0.094}) {
    double mean_opening = 0.0;
    double mean_closing = 0.0;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const Visits all = visits_of({1.0 - open, open}, 1.0 / 600.0, 600.0, 2000, 0.0, seed);
      const Chain chain = chain_of(pooled(all, 40));
      const Chain truth = chain_of(all);
      EXPECT_NEAR(chain.usual[1] / truth.usual[1], 1.0, 0.02) << open << " " << seed;
      EXPECT_NEAR(chain.rate_per_s / truth.rate_per_s, 1.0, 0.1) << open << " " << seed;
      mean_opening += 600.0 * chain.rate_per_s * chain.usual[1] / open / 20.0;
      mean_closing += 600.0 * chain.rate_per_s * chain.usual[0] / (1.0 - open) / 20.0;
      // Nats a look of someone who knows no more than the chain.
      const double score =
          -open * std::log(chain.usual[1]) - (1.0 - open) * std::log(chain.usual[0]);
      EXPECT_LE(score, open < 0.05 ? 0.20 : 0.33) << open << " " << seed;
    }
    EXPECT_NEAR(mean_opening, 1.0, 0.1) << open;
    EXPECT_NEAR(mean_closing, 1.0, 0.1) << open;
  }
}

TEST(Chain, OfThreeConfigurationsHasTheirShares) {
  const std::vector<double> usual{0.7, 0.1, 0.2};
  const Chain chain = chain_of(visits_of(usual, 1.0 / 600.0, 900.0, 3000, 0.0, 7));
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(chain.usual[k] / usual[k], 1.0, 0.15) << k;
  EXPECT_NEAR(chain.rate_per_s * 600.0, 1.0, 0.15);
}

// Sequences of one stay are one look, not many: the state that was looked at for long is not
// thereby more usual.
TEST(Chain, SequencesCloseInTimeCountAsOneDraw) {
  Visits visits;
  for (int stay = 0; stay < 40; ++stay) {
    const bool is_open = stay % 2 != 0;
    for (int i = 0; i < (is_open ? 30 : 1); ++i) {
      visits.history.append(i == 0 ? 7200.0 : 0.2);
      visits.looks.push_back(is_open ? std::vector<double>{0.0, 1.0}
                                     : std::vector<double>{1.0, 0.0});
    }
  }
  EXPECT_NEAR(chain_of(visits).usual[1], 0.5, 0.1);
}

TEST(Chain, IsFoundThroughLooksThatAreNotSure) {
  const Chain chain = chain_of(visits_of({0.9, 0.1}, 1.0 / 1200.0, 1200.0, 20000, 0.02, 5));
  EXPECT_NEAR(chain.usual[1] / 0.1, 1.0, 0.2);
  EXPECT_NEAR(chain.rate_per_s * 1200.0, 1.0, 0.2);
}

TEST(Chain, WithoutSequencesIsThePrior) {
  ChainConfig config;
  config.prior_changes = 2.0;
  config.prior_hours = 4.0;
  EXPECT_NEAR(learn_rate_per_s({}, std::vector<double>{0.5, 0.5}, config), 0.5 / 3600.0, 1e-9);
  config.prior_sightings = 0.5;
  Visits one;
  one.history.append(0.0);
  one.looks.push_back({0.0, 1.0, 0.0});
  const Chain chain = chain_of(one, config);
  EXPECT_NEAR(chain.usual[1], 1.5 / 2.5, 1e-9);
  EXPECT_NEAR(chain.usual[0], 0.5 / 2.5, 1e-9);
  EXPECT_NEAR(chain.rate_per_s, 0.5 / 3600.0, 1e-9);
}

TEST(Chain, OfSavedSequencesGivesTheRateWithTheSharesThatAreKnown) {
  const Visits visits = visits_of({0.9, 0.1}, 1.0 / 600.0, 600.0, 2000, 0.0, 3);
  std::vector<SequenceInfo> sequences;
  double now_s = 0.0;
  for (std::size_t i = 0; i < visits.looks.size(); ++i) {
    if (i > 0) now_s += visits.history.transitions()[i - 1].dt_s;
    SequenceInfo info;
    info.begin = info.end = Stamp::from_seconds(now_s);
    info.membership = visits.looks[i];
    sequences.push_back(info);
  }
  EXPECT_NEAR(600.0 * learn_rate_per_s(sequences, std::vector<double>{0.9, 0.1}, {}), 1.0, 0.2);
  sequences[1].begin = Stamp::from_seconds(-1.0);
  EXPECT_NEAR(600.0 * learn_rate_per_s(sequences, std::vector<double>{0.9, 0.1}, {}), 1.0, 0.2);
}

}  // namespace
}  // namespace strata::patch
