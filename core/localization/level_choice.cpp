// SPDX-License-Identifier: Apache-2.0
#include "core/localization/level_choice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace strata::localization {

void LevelChoice::begin(std::size_t count, std::optional<std::size_t> believed) {
  average_.assign(count, believed ? -kKnown * config_.refuted_nats : 0.0);
  leading_ = believed.value_or(0);
  if (believed) average_[leading_] = 0.0;
}

void LevelChoice::weigh(std::span<const double> log_likelihood, double elapsed_s, double memory_s) {
  double best = -std::numeric_limits<double>::infinity();
  for (const double nats : log_likelihood) best = std::max(best, nats);
  if (!std::isfinite(best)) return;  // nothing was seen anywhere
  const double kept = std::exp(-std::max(elapsed_s, 0.0) / memory_s);
  for (std::size_t i = 0; i < average_.size(); ++i) {
    const double behind = std::max(log_likelihood[i] - best, -config_.max_nats);
    average_[i] = kept * average_[i] + (1.0 - kept) * behind;
  }
  const auto top = static_cast<std::size_t>(std::max_element(average_.begin(), average_.end()) -
                                            average_.begin());
  if (average_[top] - average_[leading_] >= config_.refuted_nats) leading_ = top;
}

double LevelChoice::lead_nats() const {
  double lead = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < average_.size(); ++i) {
    if (i != leading_) lead = std::min(lead, average_[leading_] - average_[i]);
  }
  return lead;
}

std::vector<double> LevelChoice::probabilities() const {
  const double steepness = std::log(99.0) / config_.refuted_nats;
  std::vector<double> shares;
  double sum = 0.0;
  for (const double average : average_) {
    shares.push_back(std::exp(steepness * (average - average_[leading_])));
    sum += shares.back();
  }
  for (double& share : shares) share /= sum;
  return shares;
}

}  // namespace strata::localization
