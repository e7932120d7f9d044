// SPDX-License-Identifier: Apache-2.0
#include "tools/statistics/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/random/stream.hpp"

namespace strata::statistics {
namespace {

constexpr std::size_t kMaxExact = 25;

double normal_cdf(double z) { return 0.5 * std::erfc(-z / std::numbers::sqrt2); }

/// Inverse of normal_cdf by bisection: called twice a run, so plain is better than fast.
double normal_quantile(double p) {
  double low = -9.0;
  double high = 9.0;
  for (int i = 0; i < 80; ++i) {
    const double middle = 0.5 * (low + high);
    (normal_cdf(middle) < p ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// Jackknife estimate of the acceleration of the mean.
double acceleration(std::span<const double> values) {
  const double center = mean(values);
  double squares = 0.0;
  double cubes = 0.0;
  for (const double value : values) {
    // The mean without this value moves by (center - value) / (n - 1); constants cancel.
    const double shift = value - center;
    squares += shift * shift;
    cubes += shift * shift * shift;
  }
  return squares > 0.0 ? cubes / (6.0 * std::pow(squares, 1.5)) : 0.0;
}

struct SignedRanks {
  std::vector<int> doubled_ranks;  // mid-ranks are halves
  int doubled_positive = 0;
};

SignedRanks signed_ranks(std::span<const double> differences) {
  std::vector<double> kept;
  for (const double d : differences) {
    if (d != 0.0) kept.push_back(d);
  }
  std::sort(kept.begin(), kept.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
  SignedRanks ranks;
  for (std::size_t i = 0; i < kept.size();) {
    std::size_t end = i;
    while (end < kept.size() && std::abs(kept[end]) == std::abs(kept[i])) ++end;
    const int doubled = static_cast<int>(i + 1 + end);
    for (; i < end; ++i) {
      ranks.doubled_ranks.push_back(doubled);
      if (kept[i] > 0.0) ranks.doubled_positive += doubled;
    }
  }
  return ranks;
}

}  // namespace

double mean(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

Interval bootstrap_mean(std::span<const double> values, double level, std::uint64_t seed,
                        std::size_t resamples) {
  const double center = mean(values);
  const auto n = static_cast<std::uint32_t>(values.size());
  std::vector<double> means(resamples);
  for (std::size_t r = 0; r < resamples; ++r) {
    RandomStream random(seed, StreamId::kBootstrap, r);
    double sum = 0.0;
    for (std::uint32_t i = 0; i < n; ++i) sum += values[random.below(n)];
    means[r] = sum / n;
  }
  std::sort(means.begin(), means.end());
  if (means.front() == means.back()) return {center, center};

  const auto below =
      static_cast<double>(std::lower_bound(means.begin(), means.end(), center) - means.begin());
  const double count = static_cast<double>(resamples);
  const double bias = normal_quantile(std::clamp(below / count, 1.0 / count, 1.0 - 1.0 / count));
  const double a = acceleration(values);
  const auto bound = [&](double p) {
    const double z = bias + normal_quantile(p);
    const double adjusted = normal_cdf(bias + z / (1.0 - a * z));
    const auto place = static_cast<std::size_t>(adjusted * count);
    return means[std::min(place, resamples - 1)];
  };
  return {bound(0.5 * (1.0 - level)), bound(0.5 * (1.0 + level))};
}

Interval moving_block_ratio(std::span<const double> values, std::span<const double> weights,
                            std::size_t block, double level, std::uint64_t seed,
                            std::size_t resamples) {
  const std::size_t n = values.size();
  // Sums up to each entry, so that a block costs two look-ups.
  std::vector<double> value_sums(n + 1, 0.0);
  std::vector<double> weight_sums(n + 1, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    value_sums[i + 1] = value_sums[i] + values[i];
    weight_sums[i + 1] = weight_sums[i] + weights[i];
  }
  const std::size_t blocks = (n + block - 1) / block;
  const auto starts = static_cast<std::uint32_t>(n - block + 1);
  std::vector<double> ratios(resamples);
  for (std::size_t r = 0; r < resamples; ++r) {
    RandomStream random(seed, StreamId::kBootstrap, r);
    double value = 0.0;
    double weight = 0.0;
    for (std::size_t b = 0; b < blocks; ++b) {
      const std::size_t start = random.below(starts);
      value += value_sums[start + block] - value_sums[start];
      weight += weight_sums[start + block] - weight_sums[start];
    }
    ratios[r] = value / weight;
  }
  std::sort(ratios.begin(), ratios.end());
  const auto at = [&](double share) {
    return ratios[static_cast<std::size_t>(share * static_cast<double>(resamples - 1))];
  };
  return {at(0.5 * (1.0 - level)), at(0.5 * (1.0 + level))};
}

double wilcoxon_signed_rank(std::span<const double> differences) {
  const SignedRanks ranks = signed_ranks(differences);
  const std::size_t n = ranks.doubled_ranks.size();
  if (n == 0) return 1.0;
  const int total = std::accumulate(ranks.doubled_ranks.begin(), ranks.doubled_ranks.end(), 0);
  const int smaller = std::min(ranks.doubled_positive, total - ranks.doubled_positive);
  if (n <= kMaxExact) {
    // ways[s]: sign patterns whose positive (doubled) ranks sum to s.
    std::vector<double> ways(static_cast<std::size_t>(total) + 1, 0.0);
    ways[0] = 1.0;
    for (const int rank : ranks.doubled_ranks) {
      for (int s = total; s >= rank; --s) {
        ways[static_cast<std::size_t>(s)] += ways[static_cast<std::size_t>(s - rank)];
      }
    }
    double tail = 0.0;
    for (int s = 0; s <= smaller; ++s) tail += ways[static_cast<std::size_t>(s)];
    return std::min(1.0, 2.0 * tail / std::ldexp(1.0, static_cast<int>(n)));
  }
  double variance = 0.0;  // of the doubled sum: sum of (rank / 2)^2, each doubled rank squared / 4
  for (const int rank : ranks.doubled_ranks) variance += 0.25 * rank * rank;
  const double z = (smaller - 0.5 * total + 1.0) / std::sqrt(variance);
  return std::min(1.0, 2.0 * normal_cdf(z));
}

std::vector<double> holm(std::span<const double> p_values) {
  std::vector<std::size_t> order(p_values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return p_values[a] < p_values[b]; });
  std::vector<double> adjusted(p_values.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const double scaled = static_cast<double>(order.size() - i) * p_values[order[i]];
    largest = std::max(largest, std::min(1.0, scaled));
    adjusted[order[i]] = largest;
  }
  return adjusted;
}

double mcnemar_exact(std::size_t first_only, std::size_t second_only) {
  const std::size_t n = first_only + second_only;
  if (n == 0) return 1.0;
  const std::size_t smaller = std::min(first_only, second_only);
  double tail = 0.0;
  for (std::size_t k = 0; k <= smaller; ++k) {
    tail += std::exp(
        std::lgamma(static_cast<double>(n) + 1.0) - std::lgamma(static_cast<double>(k) + 1.0) -
        std::lgamma(static_cast<double>(n - k) + 1.0) - static_cast<double>(n) * std::numbers::ln2);
  }
  return std::min(1.0, 2.0 * tail);
}

double cliffs_delta(std::span<const double> a, std::span<const double> b) {
  double balance = 0.0;
  for (const double x : a) {
    for (const double y : b) balance += x > y ? 1.0 : (x < y ? -1.0 : 0.0);
  }
  return balance / (static_cast<double>(a.size()) * static_cast<double>(b.size()));
}

}  // namespace strata::statistics
