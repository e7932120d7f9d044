// SPDX-License-Identifier: Apache-2.0
/// The rate of a chain whose stationary law is known.
#pragma once

#include <span>

#include "core/patch/chain.hpp"

namespace strata::patch {

inline constexpr double kMinRate_per_s = 1e-8;  ///< one change in three years
inline constexpr double kMaxRate_per_s = 1.0;

/// What a transition says, given the stationary law.
struct TransitionOdds {
  double dt_s = 0.0;
  double count = 0.0;
  double same = 0.0;   ///< P(what was seen after | still as before), before as it is known
  double drawn = 0.0;  ///< P(what was seen after | drawn from the stationary law)
};

/// Of `count` transitions: what was seen before and after, dt_s apart, and what was usual before
/// and is after. All four have an entry a configuration.
[[nodiscard]] TransitionOdds odds_of_transition(std::span<const double> from,
                                                std::span<const double> to,
                                                std::span<const double> usual_before,
                                                std::span<const double> usual_after, double dt_s,
                                                double count);

/// ln of the posterior density of ln gamma, to a constant. O(transitions).
[[nodiscard]] double log_density_of_rate(std::span<const TransitionOdds> odds, double rate_per_s,
                                         const ChainConfig& config);

/// Its greatest value between kMinRate_per_s and kMaxRate_per_s, by golden-section search.
/// O(transitions x 40).
[[nodiscard]] double most_probable_rate(std::span<const TransitionOdds> odds,
                                        const ChainConfig& config);

}  // namespace strata::patch
