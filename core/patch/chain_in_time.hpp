// SPDX-License-Identifier: Apache-2.0
/// What is usual of the configurations of a sub-map by the time of day and week, where that is
/// known (docs/theory/habits.md).
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/patch/chain.hpp"
#include "core/periodic/periodic_shares.hpp"

namespace strata::patch {

/// A chain whose stationary law depends on the time: P(l at t | k, dt before) =
/// exp(-gamma dt) [k = l] + (1 - exp(-gamma dt)) usual_l(t).
struct ChainInTime {
  double rate_per_s = 0.0;         ///< gamma
  periodic::PeriodicShares usual;  ///< with at least one harmonic
};

/// The chain in time that explains the transitions better than `chain` does, by the Bayesian
/// information criterion; none where no time of day or week tells anything. Harmonics are added one
/// by one, the best first, those of the day once `config.min_days` days were seen, those of the
/// week after `config.min_weeks` weeks. looks as learn_chain() takes them. O(transitions), and
/// O(harmonics^2 x sweeps x hours x configurations^2 x lengths of time alike).
[[nodiscard]] std::optional<ChainInTime> learn_chain_in_time(
    std::span<const std::vector<double>> looks, const SequenceHistory& history, const Chain& chain,
    const ChainConfig& config);

/// Gives the sub-map, whose priors and rate are known, the chain in time if there is one. looks:
/// its memberships.
void follow_time(std::span<const std::vector<double>> looks, const SequenceHistory& history,
                 const ChainConfig& config, Submap& submap);

}  // namespace strata::patch
