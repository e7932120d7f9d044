// SPDX-License-Identifier: Apache-2.0
// How fast the configuration of a sub-map changes, from the sequences it was learned from
// (docs/theory/patch_localization.md, "Rates of change").
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/localization/patch_states.hpp"

namespace strata::localization {
namespace {

constexpr int kSearchSteps = 60;
constexpr double kMinRate = 1e-8;  // one change in three years
constexpr double kGreatestRate = 1.0;

struct Transition {
  double dt_s = 0.0;
  double stayed = 0.0;  ///< P(the same configuration), from the memberships of both
};

std::vector<Transition> transitions_of(const patch::Submap& submap) {
  std::vector<Transition> result;
  for (std::size_t i = 1; i < submap.sequences.size(); ++i) {
    const patch::SequenceInfo& before = submap.sequences[i - 1];
    const patch::SequenceInfo& after = submap.sequences[i];
    const double dt_s = (after.begin - before.end).seconds();
    if (dt_s <= 0.0) continue;  // runs whose stamps overlap
    double stayed = 0.0;
    for (std::size_t k = 0; k < before.membership.size(); ++k) {
      stayed += before.membership[k] * after.membership[k];
    }
    result.push_back({dt_s, std::clamp(stayed, 0.0, 1.0)});
  }
  return result;
}

}  // namespace

double learned_rate_per_s(const patch::Submap& submap, const PatchStatesConfig& config) {
  const std::vector<Transition> transitions = transitions_of(submap);
  const int configurations = static_cast<int>(submap.configurations.size());
  const double prior_s = 3600.0 * config.prior_hours;
  const auto objective = [&](double gamma) {
    double sum = config.prior_changes * std::log(gamma) - prior_s * gamma;
    for (const Transition& t : transitions) {
      const double stay = stay_probability(configurations, gamma, t.dt_s);
      const double other = configurations > 1 ? (1.0 - stay) / (configurations - 1) : 0.0;
      sum += std::log(std::max(1e-300, t.stayed * stay + (1.0 - t.stayed) * other));
    }
    return sum;
  };
  // Golden-section search over ln gamma.
  const double ratio = 0.5 * (std::sqrt(5.0) - 1.0);
  double low = std::log(kMinRate);
  double high = std::log(kGreatestRate);
  double a = high - ratio * (high - low);
  double b = low + ratio * (high - low);
  double at_a = objective(std::exp(a));
  double at_b = objective(std::exp(b));
  for (int step = 0; step < kSearchSteps; ++step) {
    if (at_a > at_b) {
      high = b;
      b = std::exchange(a, b - ratio * (b - low));
      at_b = std::exchange(at_a, objective(std::exp(a)));
    } else {
      low = a;
      a = std::exchange(b, a + ratio * (high - a));
      at_a = std::exchange(at_b, objective(std::exp(b)));
    }
  }
  return std::exp(0.5 * (low + high));
}

}  // namespace strata::localization
