// SPDX-License-Identifier: Apache-2.0
#include "core/localization/resampling.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/random/stream.hpp"

namespace strata::localization {
namespace {

TEST(LowVarianceResampling, IsUnbiasedAndWithinOneOfTheShare) {
  const std::vector<double> weights{0.05, 0.4, 0.0, 0.25, 0.3};
  const std::size_t count = 7;
  const int rounds = 20000;
  std::vector<double> drawn(weights.size(), 0.0);
  std::vector<std::uint32_t> indices;
  for (int n = 0; n < rounds; ++n) {
    draw_low_variance(weights, count,
                      RandomStream(1, StreamId::kResample, static_cast<std::uint64_t>(n)).uniform(),
                      indices);
    std::vector<int> copies(weights.size(), 0);
    for (const std::uint32_t i : indices) ++copies[i];
    for (std::size_t i = 0; i < weights.size(); ++i) {
      const double share = static_cast<double>(count) * weights[i];
      EXPECT_LT(std::abs(copies[i] - share), 1.0 + 1e-9);
      drawn[i] += copies[i];
    }
  }
  for (std::size_t i = 0; i < weights.size(); ++i) {
    EXPECT_NEAR(drawn[i] / rounds, static_cast<double>(count) * weights[i], 0.015);
  }
}

TEST(Kld, CountsFollowTheFormula) {
  EXPECT_EQ(kld_particle_count(1, 0.05, 2.326), 1U);
  // By hand: K = 2: 10 (1 - 2/9 + 2.326 sqrt(2/9))^3 = 10 * 1.87427^3; K = 101: 1000 * 1.10730^3.
  EXPECT_EQ(kld_particle_count(2, 0.05, 2.326), 66U);
  EXPECT_NEAR(static_cast<double>(kld_particle_count(101, 0.05, 2.326)), 1358.0, 2.0);
}

TEST(Kld, BinsTellPatchesApart) {
  ParticleSet particles;
  particles.resize(4);
  particles.configuration = {0, 1, 0, 1};
  particles.submap = {0, 0, 0, 0};
  particles.x_m = {0.1, 0.1, 0.2, 0.9};
  std::vector<std::uint64_t> scratch;
  EXPECT_EQ(count_bins(particles, {0, 1, 2, 3}, {}, scratch), 3U);
  EXPECT_EQ(count_bins(particles, {0, 0, 2, 2}, {}, scratch), 1U);
}

}  // namespace
}  // namespace strata::localization
