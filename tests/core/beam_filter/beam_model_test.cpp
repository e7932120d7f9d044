// SPDX-License-Identifier: Apache-2.0
#include "core/beam_filter/beam_model.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/beam_filter/config.hpp"
#include "core/random/stream.hpp"
#include "tests/core/beam_filter/likelihoods.hpp"

namespace strata::beam_filter {
namespace {

/// The objective of one cell without clamping [nats].
double cell_log_likelihood(double m, const CellCounts& counts, double prior) {
  const double passing = counts.misses > 0.0 ? counts.misses * std::log(1.0 - m) : 0.0;
  return passing + counts.hits * std::log((1.0 - prior) + (2.0 * prior - 1.0) * m);
}

CellCounts random_counts(RandomStream& random) {
  return {static_cast<double>(random.below(50)), random.uniform(0.1, 50.0)};
}

TEST(Expectation, EqualsThePrintedFormWhereThatIsDefined) {
  RandomStream random(1, StreamId::kTest);
  for (int i = 0; i < 10'000; ++i) {
    const double p = random.uniform(0.01, 0.99);
    const double m = random.uniform(1e-6, 1.0);
    const double printed = p / (p + (1.0 - p) * (1.0 / m - 1.0));
    EXPECT_NEAR(expectation(m, p), printed, 1e-12);
  }
}

TEST(Expectation, IsZeroInAFreeCellAndOneInACertainOne) {
  EXPECT_EQ(expectation(0.0, 0.9), 0.0);
  EXPECT_EQ(expectation(1.0, 0.9), 1.0);
}

TEST(Expectation, IsThePosteriorOfTheBeamLikelihood) {
  RandomStream random(2, StreamId::kTest);
  ReflectionGrid map = make_reflection_grid(0.1, {{-30, -30}, {30, 30}});
  for (float& m : map.values()) m = static_cast<float>(random.uniform(0.01, 0.99));
  for (int i = 0; i < 1'000; ++i) {
    const Ray ray{{random.uniform(-2.9, 2.9), random.uniform(-2.9, 2.9)},
                  {random.uniform(-2.9, 2.9), random.uniform(-2.9, 2.9)},
                  true};
    const double p = random.uniform(0.1, 0.95);
    const double is_static = p * std::exp(log_beam_likelihood(ray, true, map));
    const double is_dynamic = (1.0 - p) * std::exp(log_beam_likelihood(ray, false, map));
    const double m = static_cast<double>(map.at(map.cell_at(ray.to_m)));
    EXPECT_NEAR(expectation(m, p), is_static / (is_static + is_dynamic), 1e-9);
  }
}

TEST(BeamLikelihood, WeightsEachCellByTheLengthInsideIt) {
  ReflectionGrid map = make_reflection_grid(1.0, {{0, 0}, {4, 1}});
  map.values() = {0.1F, 0.2F, kUnknownReflection, 0.4F};
  const Ray hit{{0.5, 0.5}, {3.25, 0.5}, true};
  const double passing = 0.5 * std::log(1.0 - 0.1) + 1.0 * std::log(1.0 - 0.2);
  EXPECT_NEAR(log_beam_likelihood(hit, true, map), passing + std::log(0.4), 1e-7);
  EXPECT_NEAR(log_beam_likelihood(hit, false, map), passing + std::log(0.6), 1e-7);
  const Ray pass{hit.from_m, hit.to_m, false};
  EXPECT_NEAR(log_beam_likelihood(pass, true, map), passing + 0.25 * std::log(0.6), 1e-7);
}

TEST(ClosedForm, IsTheLimitOfThousandsOfEmSteps) {
  RandomStream random(3, StreamId::kTest);
  int compared = 0;
  while (compared < 2'000) {
    const CellCounts counts = random_counts(random);
    const double p = random.uniform(0.55, 0.98);
    const double ratio = counts.hits / counts.total();
    // Next to the threshold EM contracts by almost 1 a step; a limit cannot be waited for there.
    const double contraction = std::abs(ratio / critical_ratio(p) - 1.0);
    if (contraction < 0.02) continue;
    double m = p * ratio;
    for (int step = 0; step < 3'000; ++step) m = em_step(m, counts, p);
    EXPECT_NEAR(m, closed_form(counts, p, 0.0), 1e-9) << "h/(h+f) = " << ratio << ", p = " << p;
    ++compared;
  }
}

TEST(ClosedForm, EmDecaysLikeOneOverTheStepsAtTheThreshold) {
  const double p = 0.8;
  const CellCounts counts{1.0, 3.0};  // share 0.25 = (1 - p) / p
  ASSERT_DOUBLE_EQ(counts.hits / counts.total(), critical_ratio(p));
  double m = p * 0.25;
  double at_1000 = 0.0;
  for (int step = 1; step <= 2'000; ++step) {
    m = em_step(m, counts, p);
    if (step == 1'000) at_1000 = m;
  }
  EXPECT_NEAR(at_1000 / m, 2.0, 0.02);
  EXPECT_NEAR(closed_form(counts, p, 0.5), 0.0, 1e-12);
}

TEST(ClosedForm, MaximizesTheLikelihoodOfTheCell) {
  RandomStream random(4, StreamId::kTest);
  for (int i = 0; i < 500; ++i) {
    const CellCounts counts = random_counts(random);
    const double p = random.uniform(0.55, 0.98);
    const double best = cell_log_likelihood(closed_form(counts, p, 0.0), counts, p);
    for (int k = 0; k < 200; ++k) {
      EXPECT_LE(cell_log_likelihood(k / 200.0, counts, p), best + 1e-9);
    }
  }
}

TEST(ClosedForm, EmptiesCellsHitByAtMostTheCriticalShare) {
  for (const double p : {0.8, 0.9, 0.95}) {
    const double critical = critical_ratio(p);
    EXPECT_EQ(closed_form({99.0 * critical, 100.0 - 99.0 * critical}, p, 0.5), 0.0);
    EXPECT_GT(closed_form({101.0 * critical, 100.0 - 101.0 * critical}, p, 0.5), 0.0);
  }
  EXPECT_NEAR(critical_ratio(0.9), 0.11, 0.002);
  EXPECT_DOUBLE_EQ(critical_ratio(0.8), 0.25);
}

TEST(ClosedForm, KeepsAlwaysHitCellsAndKnowsNothingWithoutEvidence) {
  EXPECT_EQ(closed_form({7.0, 0.0}, 0.9, 0.5), 1.0);
  EXPECT_EQ(closed_form({0.0, 7.0}, 0.9, 0.5), 0.0);
  EXPECT_TRUE(std::isnan(closed_form({0.0, 0.49}, 0.9, 0.5)));
  EXPECT_FALSE(std::isnan(closed_form({0.0, 0.5}, 0.9, 0.5)));
}

TEST(EmStep, NeverLowersTheLikelihoodOfACell) {
  RandomStream random(5, StreamId::kTest);
  for (int i = 0; i < 2'000; ++i) {
    const CellCounts counts = random_counts(random);
    const double p = random.uniform(0.05, 0.98);  // EM rises below one half too
    double m = random.uniform(0.01, 0.99);
    double before = cell_log_likelihood(m, counts, p);
    for (int step = 0; step < 50; ++step) {
      m = em_step(m, counts, p);
      const double now = cell_log_likelihood(m, counts, p);
      EXPECT_GE(now, before - 1e-9 * std::max(1.0, std::abs(before)));
      before = now;
    }
  }
}

TEST(EmStep, NearZeroMultipliesByTheStatedFactor) {
  // r p / (1 - p): docs/theory/beam_filter.md, "Closed form".
  const CellCounts counts{5.0, 95.0};
  EXPECT_NEAR(em_step(1e-9, counts, 0.9) / 1e-9, 0.45, 1e-6);
}

TEST(EmStep, EmptiesEveryPassedCellWithAPriorOfOneHalf) {
  const CellCounts counts{95.0, 5.0};
  double m = 0.5;
  for (int step = 0; step < 2'000; ++step) m = em_step(m, counts, 0.5);
  EXPECT_LT(m, 1e-9);
}

TEST(BeamFilterConfig, RefusesAPriorOfOneHalfOrLessAndSaysWhy) {
  for (const double prior : {0.5, 0.3, 0.0, -1.0}) {
    BeamFilterConfig config;
    config.prior = prior;
    try {
      require_valid(config, "beam_filter");
      ADD_FAILURE() << "accepted prior " << prior;
    } catch (const ConfigError& error) {
      EXPECT_NE(error.problem().find("prior is one half or less"), std::string::npos);
      EXPECT_NE(error.remedy().find("above 0.5"), std::string::npos);
    }
  }
  EXPECT_NO_THROW(require_valid(BeamFilterConfig{}, "beam_filter"));
}

}  // namespace
}  // namespace strata::beam_filter
