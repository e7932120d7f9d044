// SPDX-License-Identifier: Apache-2.0
/// How the configurations of a sub-map follow each other in time
/// (docs/theory/patch_maps.md, "Chain").
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/base/config.hpp"
#include "core/patch/patch_map.hpp"
#include "core/patch/sequence_history.hpp"

namespace strata::patch {

struct ChainConfig {
  double prior_changes = 2.0;
  double prior_hours = 2.0;
  double prior_sightings = 0.5;
  int max_harmonics = 4;
  int min_days = 7;
  int min_weeks = 3;
  double amplitude = 2.0;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("prior_changes", c.prior_changes,
            {.doc = "renewals believed to have been seen beforehand", .min = 0.01});
    v.field("prior_hours", c.prior_hours, {.doc = "... in this time", .unit = "h", .min = 1e-3});
    v.field("prior_sightings", c.prior_sightings,
            {.doc = "times that each configuration is believed to have been seen beforehand",
             .min = 1e-3});
    v.field(
        "max_harmonics", c.max_harmonics,
        {.doc = "waves of the day and the week that what is usual may follow; 0: it is the same "
                "at any time, as where clocks tell no time of day",
         .min = 0,
         .max = 7});
    v.field("min_days", c.min_days,
            {.doc = "days on which a place was seen before the time of day counts: of working days "
                    "alone a weekend is not foreseen",
             .min = 2});
    v.field("min_weeks", c.min_weeks,
            {.doc = "weeks in which a place was seen before the day of the week counts", .min = 2});
    v.field("amplitude", c.amplitude,
            {.doc = "standard deviation of the waves' amplitudes, as logits", .min = 0.01});
  }
};

/// A Markov chain in continuous time: at rate gamma the configuration is drawn anew from what is
/// usual, P(l after dt | k) = exp(-gamma dt) [k = l] + (1 - exp(-gamma dt)) usual_l. Of two
/// configurations that is every chain: k is left at rate gamma (1 - usual_k).
struct Chain {
  double rate_per_s = 0.0;    ///< gamma
  std::vector<double> usual;  ///< the stationary law, one share a configuration; sums to 1
};

/// The chain that explains the sequences best: the posterior mean of `usual` under a Dirichlet
/// density of prior_sightings each, by expectation maximization over which sequences saw a fresh
/// draw, and the mode of ln gamma under a log-logistic density around prior_changes / prior_hours,
/// whose pull nowhere exceeds prior_changes nats a factor of e. Sequences that follow none at a
/// known time count as drawn. looks[i]: how likely what entry i of the history saw is in each
/// configuration, to a factor; all as long. O(sweeps x transitions x 40).
[[nodiscard]] Chain learn_chain(std::span<const std::vector<double>> looks,
                                const SequenceHistory& history, const ChainConfig& config);

/// gamma alone, of a chain whose stationary law is known. looks as above; memberships serve. Where
/// they say nothing it is prior_changes / prior_hours [1/s]. O(transitions x 40).
[[nodiscard]] double learn_rate_per_s(std::span<const std::vector<double>> looks,
                                      const SequenceHistory& history, std::span<const double> usual,
                                      const ChainConfig& config);

/// The same by the memberships of sequences none of which was pooled: for maps that were saved, or
/// came as a message, without a rate. Those of the learner have the same bits.
[[nodiscard]] double learn_rate_per_s(std::span<const SequenceInfo> sequences,
                                      std::span<const double> usual, const ChainConfig& config);

}  // namespace strata::patch
