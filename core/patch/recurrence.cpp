// SPDX-License-Identifier: Apache-2.0
#include "core/patch/recurrence.hpp"

#include <algorithm>
#include <numeric>
#include <optional>

namespace strata::patch {
namespace {

/// Of its looks, what an entry must be before it is said to have seen one configuration.
constexpr double kTells = 0.8;

std::optional<std::size_t> told(const std::vector<double>& look) {
  const double sum = std::accumulate(look.begin(), look.end(), 0.0);
  const auto best = std::max_element(look.begin(), look.end());
  if (best == look.end() || !(*best >= kTells * sum)) return std::nullopt;
  return static_cast<std::size_t>(best - look.begin());
}

}  // namespace

Recurrence recurrence_of(std::span<const std::vector<double>> looks,
                         const SequenceHistory& history) {
  if (looks.empty()) return {};
  std::vector<double> seen(looks[0].size(), 0.0);
  std::vector<std::optional<std::size_t>> kind(looks.size());
  for (std::size_t i = 0; i < looks.size(); ++i) {
    kind[i] = told(looks[i]);
    if (kind[i]) seen[*kind[i]] += history.counts()[i];
  }
  std::vector<double> appeared = seen;
  for (const Transition& t : history.transitions()) {
    const auto& to = kind[t.to];
    if (to && kind[t.from] == to) appeared[*to] -= t.count;
  }
  const auto usual =
      static_cast<std::size_t>(std::max_element(seen.begin(), seen.end()) - seen.begin());
  Recurrence result;
  for (std::size_t k = 0; k < seen.size(); ++k) {
    if (k == usual || seen[k] == 0.0) continue;
    result.appearances += std::max(appeared[k], 1.0);
    result.kinds += 1.0;
  }
  return result;
}

Recurrence recurrence_of(const Submap& submap) {
  std::vector<std::vector<double>> memberships;
  memberships.reserve(submap.sequences.size());
  for (const SequenceInfo& sequence : submap.sequences) {
    memberships.push_back(sequence.membership);
    memberships.back().resize(submap.configurations.size(), 0.0);
  }
  return recurrence_of(memberships, history_of(submap.sequences));
}

std::vector<double> return_probabilities(std::span<const Recurrence> submaps) {
  double returns = 2.0;
  double chances = 3.0;
  for (const Recurrence& submap : submaps) {
    returns += submap.returns();
    chances += submap.chances();
  }
  const double everywhere = returns / chances;
  std::vector<double> result;
  result.reserve(submaps.size());
  for (const Recurrence& submap : submaps) {
    result.push_back((submap.returns() + everywhere) / (submap.chances() + 1.0));
  }
  return result;
}

}  // namespace strata::patch
