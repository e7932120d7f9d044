// SPDX-License-Identifier: Apache-2.0
#include "core/patch/chain.hpp"

#include <algorithm>
#include <cmath>

#include "core/patch/chain_rate.hpp"
#include "core/patch/looks.hpp"

namespace strata::patch {
namespace {

constexpr int kMaxSweeps = 30;
constexpr double kShareTolerance = 1e-4;

std::vector<TransitionOdds> odds_of(std::span<const std::vector<double>> looks,
                                    std::span<const Transition> transitions,
                                    std::span<const double> usual) {
  std::vector<TransitionOdds> odds;
  odds.reserve(transitions.size());
  for (const Transition& t : transitions) {
    odds.push_back(odds_of_transition(looks[t.from], looks[t.to], usual, usual, t.dt_s, t.count));
  }
  return odds;
}

/// Adds `count` sightings of a draw: those of each configuration, given what was seen.
void add_sightings(const std::vector<double>& look, std::span<const double> usual, double count,
                   std::vector<double>& sightings) {
  const double sum = likelihood(look, usual);
  if (!(sum > 0.0)) return;
  for (std::size_t k = 0; k < usual.size(); ++k) {
    sightings[k] += count * look[k] * usual[k] / sum;
  }
}

/// One sweep of expectation maximization: how often a fresh draw showed each configuration.
std::vector<double> next_usual(std::span<const std::vector<double>> looks,
                               const SequenceHistory& history, std::span<const TransitionOdds> odds,
                               std::span<const double> usual, const ChainConfig& config,
                               double rate_per_s) {
  std::vector<double> sightings(usual.size(), config.prior_sightings);
  std::vector<double> first = history.counts();
  for (std::size_t i = 0; i < odds.size(); ++i) {
    const Transition& t = history.transitions()[i];
    const double kept = std::exp(-rate_per_s * odds[i].dt_s);
    const double drawn = (1.0 - kept) * odds[i].drawn;
    const double all = kept * odds[i].same + drawn;
    first[t.to] -= t.count;
    if (all > 0.0) add_sightings(looks[t.to], usual, t.count * drawn / all, sightings);
  }
  for (std::size_t i = 0; i < first.size(); ++i) {
    if (first[i] > 0.0) add_sightings(looks[i], usual, first[i], sightings);
  }
  double sum = 0.0;
  for (const double s : sightings) sum += s;
  for (double& s : sightings) s /= sum;
  return sightings;
}

}  // namespace

Chain learn_chain(std::span<const std::vector<double>> looks, const SequenceHistory& history,
                  const ChainConfig& config) {
  Chain chain;
  if (looks.empty()) return chain;
  const std::size_t configurations = looks[0].size();
  chain.usual.assign(configurations, 1.0 / static_cast<double>(configurations));
  // At first as if every sequence were a draw.
  chain.rate_per_s = kMaxRate_per_s;
  for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
    std::vector<TransitionOdds> odds = odds_of(looks, history.transitions(), chain.usual);
    const std::vector<double> usual =
        next_usual(looks, history, odds, chain.usual, config, chain.rate_per_s);
    odds = odds_of(looks, history.transitions(), usual);
    const double rate_per_s = most_probable_rate(odds, config);
    double moved = std::abs(std::log(rate_per_s / chain.rate_per_s));
    for (std::size_t k = 0; k < configurations; ++k) {
      moved = std::max(moved, std::abs(usual[k] - chain.usual[k]));
    }
    chain.usual = usual;
    chain.rate_per_s = rate_per_s;
    if (moved < kShareTolerance) break;
  }
  return chain;
}

double learn_rate_per_s(std::span<const std::vector<double>> looks, const SequenceHistory& history,
                        std::span<const double> usual, const ChainConfig& config) {
  return most_probable_rate(odds_of(looks, history.transitions(), usual), config);
}

double learn_rate_per_s(std::span<const SequenceInfo> sequences, std::span<const double> usual,
                        const ChainConfig& config) {
  std::vector<std::vector<double>> looks;
  for (const SequenceInfo& sequence : sequences) {
    looks.push_back(sequence.membership);
    looks.back().resize(usual.size(), 0.0);
  }
  return learn_rate_per_s(looks, history_of(sequences), usual, config);
}

}  // namespace strata::patch
