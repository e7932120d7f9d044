// SPDX-License-Identifier: Apache-2.0
/// A level that has learned one state and from then on sees another: what theory and what the level
/// itself say of how long the old one lives.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "memory/decoding/decode.hpp"
#include "memory/levels/node_level.hpp"

namespace strata::memory::level_life {

inline constexpr int kBins = 60;
inline constexpr float kOld_m = 1.5F;
inline constexpr float kNew_m = 2.5F;

/// A level of N = `samples` that takes an observation in with probability q.
struct Rates {
  int samples = 0;
  double q = 1.0;

  /// Share of the old samples left after t observations, (1 - q / N)^t.
  [[nodiscard]] double survival(double t) const { return std::pow(1.0 - q / samples, t); }
  /// Observations until the last old sample of a bin has left: with m of them left the next one to
  /// leave takes N / (q m) in the mean, so N / q times the N-th harmonic number in all.
  [[nodiscard]] double forgetting() const {
    double sum = 0.0;
    for (int m = 1; m <= samples; ++m) sum += samples / (q * m);
    return sum;
  }
};

/// Means over all bins and seeds.
struct Life {
  std::vector<double> survival;  ///< share of old samples after t = 0, 1, ... observations
  std::vector<double> holding;   ///< share of the bins with an old sample
  double adaptation = 0.0;  ///< first observation after which the decoded scan is the new state
  double forgetting = 0.0;  ///< observations until the last old sample of a bin has left
};

/// Observes the new state until no bin of any seed holds an old sample, or for 20 times as long as
/// that should take.
inline Life live(const Rates& rates, int seeds) {
  Life life;
  const auto longest = static_cast<std::size_t>(20.0 * rates.forgetting());
  for (int seed = 1; seed <= seeds; ++seed) {
    RandomStream random(static_cast<std::uint64_t>(seed), StreamId::kTest);
    NodeLevel level({kBins, 16, 4.0}, rates.samples, false);
    for (int i = 0; i < rates.samples; ++i) level.insert(VirtualScan(kBins, kOld_m), random);
    bool has_adapted = false;
    int holding = kBins;
    for (std::size_t t = 0; holding > 0 && t < longest; ++t) {
      if (t > 0 && random.bernoulli(rates.q)) level.insert(VirtualScan(kBins, kNew_m), random);
      std::ptrdiff_t old = 0;
      holding = 0;
      for (int a = 0; a < kBins; ++a) {
        const auto here = std::count(level.samples(a).begin(), level.samples(a).end(), kOld_m);
        old += here;
        holding += here > 0 ? 1 : 0;
      }
      if (t >= life.survival.size()) {
        life.survival.push_back(0.0);
        life.holding.push_back(0.0);
      }
      life.survival[t] += static_cast<double>(old) / (kBins * rates.samples * seeds);
      life.holding[t] += static_cast<double>(holding) / (kBins * seeds);
      // A bin that holds an old sample after t observations forgets after t + 1 at the earliest.
      life.forgetting += static_cast<double>(holding) / (kBins * seeds);
      if (has_adapted) continue;
      const std::vector<float> shown = decode(level, exact_decoding()).range_m;
      has_adapted = std::count(shown.begin(), shown.end(), kNew_m) == kBins;
      if (has_adapted) life.adaptation += static_cast<double>(t) / seeds;
    }
  }
  return life;
}

/// Observations after which half of the samples are old, between two observations as if they left
/// evenly.
inline double half_life(const Life& life) {
  std::size_t t = 0;
  while (life.survival[t] > 0.5) ++t;
  const double before = life.survival[t - 1];
  return static_cast<double>(t) - 1.0 + (before - 0.5) / (before - life.survival[t]);
}

}  // namespace strata::memory::level_life
