// SPDX-License-Identifier: Apache-2.0
#include "core/periodic/fit_shares.hpp"

#include <cmath>
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include "core/random/stream.hpp"

namespace strata::periodic {
namespace {

constexpr double kAmplitude = 2.0;

/// Draws of a model, so many an hour.
WeeklySightings drawn(const PeriodicShares& model, int an_hour, std::uint64_t seed) {
  WeeklySightings sightings(model.logit.size());
  RandomStream random(seed, StreamId::kTest);
  std::vector<double> shares(model.logit.size());
  for (int hour = 0; hour < kHoursAWeek; ++hour) {
    shares_at(model, middle_of_hour(hour), shares);
    for (int i = 0; i < an_hour; ++i) {
      double left = random.uniform();
      std::size_t k = 0;
      while (k + 1 < shares.size() && (left -= shares[k]) >= 0.0) ++k;
      sightings.at(hour, k) += 1.0;
    }
  }
  return sightings;
}

/// ln of the posterior density, written down anew.
double log_density(const PeriodicShares& model, const WeeklySightings& sightings) {
  double sum = 0.0;
  std::vector<double> shares(model.logit.size());
  for (int hour = 0; hour < kHoursAWeek; ++hour) {
    shares_at(model, middle_of_hour(hour), shares);
    for (std::size_t k = 0; k < shares.size(); ++k) {
      sum += sightings.of(hour)[k] * std::log(shares[k]);
    }
  }
  for (const Harmonic& wave : model.harmonics) {
    for (std::size_t k = 0; k < model.logit.size(); ++k) {
      sum -= 0.5 * (wave.cosine[k] * wave.cosine[k] + wave.sine[k] * wave.sine[k]) /
             (kAmplitude * kAmplitude);
    }
  }
  return sum;
}

const PeriodicShares kThreeStates{
    {0.3, -0.5, 0.2},
    {{7, {1.0, -1.0, 0.0}, {0.2, 0.4, -0.6}}, {2, {0.5, -0.2, -0.3}, {-0.4, 0.1, 0.3}}}};

TEST(FitShares, WithoutWavesAreTheSharesOfAllSightings) {
  WeeklySightings sightings(2);
  sightings.at(3, 0) = 30.0;
  sightings.at(100, 1) = 10.0;
  const PeriodicShares fit = fit_shares(sightings, {}, kAmplitude);
  EXPECT_FALSE(fit.is_periodic());
  std::vector<double> shares(2);
  shares_at(fit, 0.5, shares);
  EXPECT_NEAR(shares[1], 0.25, 1e-4);
}

TEST(FitShares, FindTheWavesThatSightingsWereDrawnFrom) {
  const std::vector<int> cycles{7, 2};
  const PeriodicShares fit = fit_shares(drawn(kThreeStates, 400, 1), cycles, kAmplitude);
  std::vector<double> expected(3);
  std::vector<double> got(3);
  for (int hour = 0; hour < kHoursAWeek; ++hour) {
    shares_at(kThreeStates, middle_of_hour(hour), expected);
    shares_at(fit, middle_of_hour(hour), got);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(got[k], expected[k], 0.03) << hour << " " << k;
  }
}

TEST(FitShares, HaveTheGreatestDensityAround) {
  const WeeklySightings sightings = drawn(kThreeStates, 3, 2);
  const std::vector<int> cycles{7, 2};
  const PeriodicShares fit = fit_shares(sightings, cycles, kAmplitude);
  const double best = log_density(fit, sightings);
  RandomStream random(5, StreamId::kTest);
  for (int i = 0; i < 200; ++i) {
    PeriodicShares near = fit;
    for (std::size_t k = 0; k < 3; ++k) {
      near.logit[k] += 0.05 * random.normal();
      for (Harmonic& wave : near.harmonics) {
        wave.cosine[k] += 0.05 * random.normal();
        wave.sine[k] += 0.05 * random.normal();
      }
    }
    EXPECT_LT(log_density(near, sightings), best) << i;
  }
}

// The density of the amplitudes counts as much as it should: few sightings, by central differences.
TEST(FitShares, LieWhereTheDensityIsFlat) {
  const WeeklySightings sightings = drawn(kThreeStates, 1, 4);
  const std::vector<int> cycles{7, 2};
  const PeriodicShares fit = fit_shares(sightings, cycles, kAmplitude);
  for (std::size_t h = 0; h < cycles.size(); ++h) {
    for (std::size_t k = 0; k < 3; ++k) {
      for (auto Harmonic::*wave : {&Harmonic::cosine, &Harmonic::sine}) {
        PeriodicShares more = fit;
        PeriodicShares less = fit;
        constexpr double kStep = 1e-4;
        (more.harmonics[h].*wave)[k] += kStep;
        (less.harmonics[h].*wave)[k] -= kStep;
        EXPECT_NEAR((log_density(more, sightings) - log_density(less, sightings)) / (2.0 * kStep),
                    0.0, 1e-4)
            << h << " " << k;
      }
    }
  }
}

TEST(FitShares, FindTheSameFromWhereverTheyBegin) {
  const WeeklySightings sightings = drawn(kThreeStates, 3, 3);
  const std::vector<int> cycles{2, 7};
  const PeriodicShares fit = fit_shares(sightings, cycles, kAmplitude);
  const PeriodicShares again = fit_shares(sightings, cycles, kAmplitude, kThreeStates);
  EXPECT_NEAR(log_density(again, sightings), log_density(fit, sightings), 1e-6);
  EXPECT_EQ(again.harmonics[0].cycles_a_week, 2);
}

TEST(FitShares, OfAStateThatIsAlwaysSeenAtOneHourStayFinite) {
  WeeklySightings sightings(2);
  for (int day = 0; day < 7; ++day) {
    sightings.at(24 * day + 8, 1) = 1e6;
    sightings.at(24 * day + 20, 0) = 1e6;
  }
  const std::vector<int> cycles{7, 14, 21, 28};
  const PeriodicShares fit = fit_shares(sightings, cycles, kAmplitude);
  EXPECT_TRUE(is_sound(fit));
  std::vector<double> shares(2);
  shares_at(fit, middle_of_hour(8), shares);
  EXPECT_GT(shares[1], 0.99);
  EXPECT_TRUE(is_sound(fit_shares(WeeklySightings(2), cycles, kAmplitude))) << "nothing was seen";
}

}  // namespace
}  // namespace strata::periodic
