// SPDX-License-Identifier: Apache-2.0
#include "core/rays/beam_mixture.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/config.hpp"
#include "core/random/stream.hpp"
#include "core/rays/column_math.hpp"
#include "core/rays/scan_mixture.hpp"
#include "tests/support/every_target.hpp"

namespace strata::rays {
namespace {

// Else held-out likelihoods favour some maps: docs/theory/patch_localization.md, "Beam model".
TEST(BeamMixture, SumsToOneForEveryExpectedRange) {
  const double r_max = 8.0;
  const BeamMixture mixture({}, r_max);
  for (const double expected :
       {0.0, 0.02, 0.2, 1.0, 4.0, 7.9, 8.0, std::numeric_limits<double>::infinity()}) {
    const int steps = 80000;
    const double h = r_max / steps;
    double integral = 0.0;
    for (int i = 0; i < steps; ++i) integral += h * mixture.density((i + 0.5) * h, expected);
    EXPECT_NEAR(integral + mixture.no_return(expected), 1.0, 1e-4) << "expected " << expected;
  }
}

TEST(BeamMixture, RefusesWeightsThatDoNotSumToOne) {
  BeamMixtureConfig config;
  config.hit_weight = 0.7;
  EXPECT_THROW(BeamMixture(config, 8.0), ConfigError);
}

TEST(BeamMixture, PrefersTheExpectedRange) {
  const BeamMixture mixture({}, 8.0);
  EXPECT_GT(mixture.density(3.0, 3.0), 10.0 * mixture.density(5.0, 3.0));
  // Something in the way is likelier than a beam through the wall.
  EXPECT_GT(mixture.density(1.0, 3.0), mixture.density(5.0, 3.0));
  EXPECT_GT(mixture.no_return(std::numeric_limits<double>::infinity()), mixture.no_return(3.0));
}

/// Every beam from eight bundles at once, each with what another beam expects; and as rows, which
/// it returns where anything is expected.
std::vector<double> check_rows(const ScanMixture& scan, const std::vector<double>& expected,
                               const std::vector<double>& logs) {
  constexpr std::size_t kBundles = BeamBundles::kVector;
  const std::size_t beams = expected.size();
  std::vector<double> expected_of_bundles;
  std::vector<SingleRow> rows;
  for (std::size_t b = 0; b < beams; ++b) {
    rows.push_back({static_cast<std::uint32_t>(b), 0, 0});
    for (std::size_t n = 0; n < kBundles; ++n) {
      expected_of_bundles.push_back(expected[(b + 37 * n) % beams]);
    }
  }
  std::vector<double> one_by_one(beams * kBundles);
  for (std::size_t k = 0; k < one_by_one.size(); ++k) {
    scan.log_likelihoods(k / kBundles, 1, &expected_of_bundles[k], &one_by_one[k]);
  }
  std::vector<double> of_bundles(beams * kBundles);
  scan.log_likelihoods_of_bundles(kBundles, expected_of_bundles.data(), of_bundles.data());
  EXPECT_EQ(of_bundles, one_by_one);
  for (std::size_t b = 0; b < beams; ++b) EXPECT_EQ(of_bundles[b * kBundles], logs[b]);
  std::vector<double> of_rows(beams * kBundles);
  scan.likelihoods_of_rows(rows, expected_of_bundles.data(), of_rows.data());
  for (std::size_t k = 0; k < of_rows.size(); ++k) {
    if (expected_of_bundles[k] < scan.mixture().r_max_m()) {
      EXPECT_NEAR(std::log(of_rows[k]), one_by_one[k], 1e-12);
    } else {
      of_rows[k] = 0.0;
    }
  }
  return of_rows;
}

TEST(ScanMixture, EveryTargetGivesTheLogarithmsOfTheMixture) {
  RandomStream random(4, StreamId::kTest);
  BeamMixtureConfig config;
  BeamMixtureConfig no_random;  // far from everything the likelihood is 0
  no_random.random_weight = 0.0;
  no_random.short_weight = 0.18;
  for (const BeamMixtureConfig& constants : {config, no_random}) {
    const BeamMixture mixture(constants, 8.0);
    ScanBeams beams;
    std::vector<double> expected;
    std::vector<double> every_beam;
    for (int k = 0; k < 501; ++k) {
      every_beam.push_back(k);
      const bool is_hit = k % 4 != 0;
      beams.range_m.push_back(is_hit ? random.uniform(0.0, 7.99) : 8.0);
      beams.is_hit.push_back(is_hit ? 1 : 0);
      expected.push_back(k % 11 == 0 ? std::numeric_limits<double>::infinity()
                                     : (k % 13 == 0 ? 0.0 : random.uniform(0.0, 9.0)));
    }
    ScanMixture scan;
    scan.prepare(mixture, beams);
    std::vector<double> first;
    std::vector<double> first_rows;
    test::for_every_target([&] {
      std::vector<double> logs(expected.size());
      scan.log_likelihoods(0, 500, expected.data(), logs.data());
      scan.log_likelihoods(500, 1, expected.data() + 500, logs.data() + 500);
      for (std::size_t k = 0; k < logs.size(); ++k) {
        const double slow = mixture.likelihood(beams.is_hit[k] != 0, beams.range_m[k], expected[k]);
        EXPECT_NEAR(logs[k], std::log(std::max(slow, 1e-300)), 1e-7);
      }
      if (first.empty()) first = logs;
      EXPECT_EQ(logs, first);
      std::vector<double> of_any(expected.size());
      scan.log_likelihoods_of(every_beam.data(), 501, expected.data(), of_any.data());
      EXPECT_EQ(of_any, first);
      const std::vector<double> of_rows = check_rows(scan, expected, first);
      if (first_rows.empty()) first_rows = of_rows;
      EXPECT_EQ(of_rows, first_rows);
    });
  }
}

TEST(ScanMixture, EveryTargetMixesRowsAsTheSumOfTheirLikelihoods) {
  constexpr std::size_t kStride = 64;
  constexpr double kNever = -std::numeric_limits<double>::infinity();
  RandomStream random(5, StreamId::kTest);
  const std::vector<double> weight{0.5, 0.2, 0.3};
  std::vector<double> logs(weight.size() * kStride);
  for (double& log_p : logs) log_p = random.uniform(-30.0, 4.0);
  for (std::size_t r = 0; r < weight.size(); ++r) logs[r * kStride + 7] = kNever;
  logs[9] = kNever;
  for (const std::size_t count : {std::size_t{61}, kStride}) {
    std::vector<double> first;
    test::for_every_target([&] {
      std::vector<double> mixed = logs;  // in place
      mix_rows(weight, mixed.data(), kStride, count, mixed.data());
      for (std::size_t k = 0; k < count; ++k) {
        double sum = 0.0;
        for (std::size_t r = 0; r < weight.size(); ++r) {
          sum += weight[r] * std::exp(logs[r * kStride + k]);
        }
        EXPECT_NEAR(mixed[k], std::log(std::max(sum, 1e-300)), 1e-12 * std::abs(mixed[k]) + 1e-13);
      }
      EXPECT_EQ(mixed[count], logs[count]) << "beyond the columns";
      if (first.empty()) first = mixed;
      EXPECT_EQ(mixed, first);
    });
  }
}

TEST(BeamMixture, LimitedToAnotherRangeIsTheMixtureOfThatRange) {
  for (const double r_max : {0.5, 8.0, 30.0}) {
    const BeamMixture limited = BeamMixture({}, 1.0).limited_to(r_max);
    const BeamMixture made({}, r_max);
    for (const double free_m : {0.0, 0.3 * r_max, 0.9 * r_max}) {
      for (const double z : {0.1 * r_max, 0.5 * r_max, 0.95 * r_max}) {
        EXPECT_EQ(limited.likelihood_beyond(true, z, free_m),
                  made.likelihood_beyond(true, z, free_m));
        EXPECT_EQ(limited.density(z, free_m), made.density(z, free_m));
      }
      EXPECT_EQ(limited.likelihood_beyond(false, r_max, free_m),
                made.likelihood_beyond(false, r_max, free_m));
    }
  }
}

TEST(BeamMixture, BeyondAFreeWayIsADistributionToo) {
  const double r_max = 8.0;
  const BeamMixture mixture({}, r_max);
  for (const double free_m : {0.0, 0.3, 3.0, 7.9, 8.0, 20.0}) {
    double total = mixture.likelihood_beyond(false, r_max, free_m);
    constexpr int kSteps = 80000;
    for (int i = 0; i < kSteps; ++i) {
      const double z = (i + 0.5) * r_max / kSteps;
      total += mixture.likelihood_beyond(true, z, free_m) * r_max / kSteps;
    }
    EXPECT_NEAR(total, 1.0, 1e-4) << free_m;
  }
  // A beam may end anywhere beyond, and hardly before.
  EXPECT_GT(mixture.likelihood_beyond(true, 3.1, 3.0),
            3.0 * mixture.likelihood_beyond(true, 2.9, 3.0));
}

}  // namespace
}  // namespace strata::rays
