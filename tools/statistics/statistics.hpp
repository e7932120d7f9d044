// SPDX-License-Identifier: Apache-2.0
/// Paired comparisons of localization runs. The unit is one (log, seed) pair, never one scan: scans
/// of a run depend on each other (docs/theory/evaluation.md, "Statistics").
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace strata::statistics {

struct Interval {
  double low = 0.0;
  double high = 0.0;
};

/// Median; the mean of the middle pair for an even count. Requires values.
[[nodiscard]] double median(std::vector<double> values);
[[nodiscard]] double mean(std::span<const double> values);

/// Bias-corrected and accelerated bootstrap interval of the mean [efron1987better], at the given
/// level (0.95). One value gives an interval of no width. Deterministic for a seed. Requires
/// values.
[[nodiscard]] Interval bootstrap_mean(std::span<const double> values, double level,
                                      std::uint64_t seed, std::size_t resamples = 2000);

/// Percentile interval of sum(values) / sum(weights) of one series in time, whose entries depend on
/// their neighbours: moving blocks of `block` entries are drawn [kunsch1989jackknife]. Equal
/// lengths; deterministic for a seed. Requires 1 <= block <= values.size() and positive weights.
[[nodiscard]] Interval moving_block_ratio(std::span<const double> values,
                                          std::span<const double> weights, std::size_t block,
                                          double level, std::uint64_t seed,
                                          std::size_t resamples = 2000);

/// Two-sided p of the signed-rank test [wilcoxon1945individual] on paired differences; exact (by
/// counting sign patterns) for up to 25 non-zero differences, ties shared by mid-ranks; beyond that
/// the normal approximation. 1 when no difference is left.
[[nodiscard]] double wilcoxon_signed_rank(std::span<const double> differences);

/// Step-down adjusted p-values [holm1979simple], in the order given.
[[nodiscard]] std::vector<double> holm(std::span<const double> p_values);

/// Two-sided exact test of McNemar from the two discordant counts: failures of the first only, of
/// the second only. 1 when both are zero.
[[nodiscard]] double mcnemar_exact(std::size_t first_only, std::size_t second_only);

/// Cliff's delta in [-1, 1]: P(a > b) - P(a < b) over all pairs. Requires values in both.
[[nodiscard]] double cliffs_delta(std::span<const double> a, std::span<const double> b);

}  // namespace strata::statistics
