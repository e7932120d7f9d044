// SPDX-License-Identifier: Apache-2.0
#include "tests/memory/decoding/level_life.hpp"

#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "memory/levels/level_config.hpp"

namespace strata::memory::level_life {
namespace {

/// short, mid and long: survival, adaptation and forgetting within a tenth of theory.
class LevelLife : public testing::TestWithParam<Rates> {};

TEST_P(LevelLife, GoesAsTheoryHasIt) {
  const Rates& rates = GetParam();
  constexpr int kSeeds = 20;
  const Life life = live(rates, kSeeds);
  const double theory = half_life_observations(rates.samples, rates.q);
  EXPECT_NEAR(half_life(life), theory, 0.1 * theory);
  for (std::size_t t = 0; t < static_cast<std::size_t>(2.0 * theory); ++t) {
    EXPECT_NEAR(life.survival[t], rates.survival(static_cast<double>(t)), 0.05) << t;
  }
  // The decoded scan shows whole observations only: the short level's 3.1 lies between the third,
  // which leaves 51% old, and the fourth, which leaves 41%.
  EXPECT_NEAR(life.adaptation, theory, std::max(0.5, 0.1 * theory));
  EXPECT_NEAR(life.forgetting, rates.forgetting(), 0.1 * rates.forgetting());
}

INSTANTIATE_TEST_SUITE_P(UsualLevels, LevelLife,
                         testing::Values(Rates{5, 1.0}, Rates{20, 0.5}, Rates{50, 0.05}),
                         [](const auto& usual) {
                           return "Of" + std::to_string(usual.param.samples) + "Samples";
                         });

}  // namespace
}  // namespace strata::memory::level_life
