// SPDX-License-Identifier: Apache-2.0
#include "core/localization/beam_mixture.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "core/base/config.hpp"

namespace strata::localization {
namespace {

// Defect of unnormalized mixtures (SPEC C3): held-out likelihoods would favour some maps.
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

}  // namespace
}  // namespace strata::localization
