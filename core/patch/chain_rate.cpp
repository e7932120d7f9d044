// SPDX-License-Identifier: Apache-2.0
#include "core/patch/chain_rate.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "core/patch/looks.hpp"

namespace strata::patch {
namespace {
constexpr int kSearchSteps = 40;
}  // namespace

TransitionOdds odds_of_transition(std::span<const double> from, std::span<const double> to,
                                  std::span<const double> usual_before,
                                  std::span<const double> usual_after, double dt_s, double count) {
  double same = 0.0;
  for (std::size_t k = 0; k < from.size(); ++k) same += from[k] * usual_before[k] * to[k];
  const double all = likelihood(from, usual_before);
  return {dt_s, count, all > 0.0 ? same / all : 0.0, likelihood(to, usual_after)};
}

double log_density_of_rate(std::span<const TransitionOdds> odds, double rate_per_s,
                           const ChainConfig& config) {
  const double ratio = rate_per_s * 3600.0 * config.prior_hours / config.prior_changes;
  double sum = config.prior_changes * (std::log(ratio) - 2.0 * std::log1p(ratio));
  for (const TransitionOdds& one : odds) {
    const double kept = std::exp(-rate_per_s * one.dt_s);
    const double p = kept * one.same + (1.0 - kept) * one.drawn;
    sum += one.count * std::log(std::max(1e-300, p));
  }
  return sum;
}

double most_probable_rate(std::span<const TransitionOdds> odds, const ChainConfig& config) {
  const double ratio = 0.5 * (std::sqrt(5.0) - 1.0);
  const auto density = [&](double ln_rate) {
    return log_density_of_rate(odds, std::exp(ln_rate), config);
  };
  double low = std::log(kMinRate_per_s);
  double high = std::log(kMaxRate_per_s);
  double a = high - ratio * (high - low);
  double b = low + ratio * (high - low);
  double at_a = density(a);
  double at_b = density(b);
  for (int step = 0; step < kSearchSteps; ++step) {
    if (at_a > at_b) {
      high = b;
      b = std::exchange(a, b - ratio * (b - low));
      at_b = std::exchange(at_a, density(a));
    } else {
      low = a;
      a = std::exchange(b, a + ratio * (high - a));
      at_a = std::exchange(at_b, density(b));
    }
  }
  return std::exp(0.5 * (low + high));
}

}  // namespace strata::patch
