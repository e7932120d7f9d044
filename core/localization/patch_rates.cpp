// SPDX-License-Identifier: Apache-2.0
// What the filter takes from the chain of a sub-map (docs/theory/patch_localization.md, "Rates of
// change").
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "core/localization/patch_states.hpp"
#include "core/patch/chain_in_time.hpp"
#include "core/patch/recurrence.hpp"

namespace strata::localization {
namespace {

/// Of a map that came without a rate, by the memberships of its sequences.
std::optional<patch::ChainInTime> in_time_of(const patch::Submap& submap,
                                             const patch::Chain& chain) {
  std::vector<std::vector<double>> memberships;
  for (const patch::SequenceInfo& sequence : submap.sequences) {
    memberships.push_back(sequence.membership);
    memberships.back().resize(chain.usual.size(), 0.0);
  }
  return patch::learn_chain_in_time(memberships, patch::history_of(submap.sequences), chain, {});
}

}  // namespace

FilterChain chain_of(const patch::Submap& submap, double min_share) {
  std::vector<double> priors;
  double sum = 0.0;
  bool are_shares = true;
  for (const patch::Configuration& configuration : submap.configurations) {
    are_shares = are_shares && configuration.prior >= 0.0 && std::isfinite(configuration.prior);
    sum += priors.emplace_back(configuration.prior);
  }
  if (!are_shares || !(sum > 0.0) || !std::isfinite(sum)) {
    priors.assign(priors.size(), 1.0 / static_cast<double>(priors.size()));
    sum = 1.0;
  }
  FilterChain known;
  patch::Chain& chain = known.chain;
  chain.rate_per_s = submap.change_rate_per_s;
  if (!(chain.rate_per_s > 0.0) || !std::isfinite(chain.rate_per_s)) {
    chain.rate_per_s = patch::learn_rate_per_s(submap.sequences, priors, {});
    if (auto in_time = in_time_of(submap, {chain.rate_per_s, priors})) {
      chain.rate_per_s = in_time->rate_per_s;
      known.in_time = std::move(in_time->usual);
    }
  } else if (periodic::is_sound(submap.usual) && submap.usual.logit.size() == priors.size()) {
    known.in_time = submap.usual;
  }
  double floored = 0.0;
  for (const double prior : priors) {
    floored += chain.usual.emplace_back(std::max(min_share, prior / sum));
  }
  for (double& share : chain.usual) share /= floored;
  return known;
}

std::vector<double> shares_of_something_else(const patch::PatchMap& map) {
  // What a thing that nobody saw costs before it explains anything [nats]: where it stands. Chosen
  // on wards and corridors 11 to 22 (docs/results.md, "Something else").
  constexpr double kPlace_nats = 3.0;
  std::vector<patch::Recurrence> seen;
  for (const patch::Submap& submap : map.submaps) seen.push_back(patch::recurrence_of(submap));
  std::vector<double> shares = patch::return_probabilities(seen);
  for (std::size_t s = 0; s < shares.size(); ++s) {
    const patch::Submap& submap = map.submaps[s];
    const bool is_known = submap.sequences.size() > 1 && submap.configurations.size() > 1;
    const std::vector<double> usual = chain_of(submap, 0.0).chain.usual;
    const double most = *std::max_element(usual.begin(), usual.end());
    shares[s] = is_known ? (1.0 - shares[s]) * (1.0 - most) * std::exp(-kPlace_nats) : 0.0;
  }
  return shares;
}

}  // namespace strata::localization
