// SPDX-License-Identifier: Apache-2.0
// What the filter takes from the chain of a sub-map (docs/theory/patch_localization.md, "Rates of
// change").
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/localization/patch_states.hpp"

namespace strata::localization {

patch::Chain chain_of(const patch::Submap& submap, double min_share) {
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
  patch::Chain chain;
  chain.rate_per_s = submap.change_rate_per_s;
  if (!(chain.rate_per_s > 0.0) || !std::isfinite(chain.rate_per_s)) {
    chain.rate_per_s = patch::learn_rate_per_s(submap.sequences, priors, {});
  }
  double floored = 0.0;
  for (const double prior : priors) {
    floored += chain.usual.emplace_back(std::max(min_share, prior / sum));
  }
  for (double& share : chain.usual) share /= floored;
  return chain;
}

}  // namespace strata::localization
