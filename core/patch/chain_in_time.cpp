// SPDX-License-Identifier: Apache-2.0
#include "core/patch/chain_in_time.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <tuple>
#include <utility>

#include "core/patch/chain_rate.hpp"
#include "core/patch/looks.hpp"
#include "core/periodic/fit_shares.hpp"

namespace strata::patch {
namespace {

using periodic::kHoursAWeek;
using periodic::PeriodicShares;

constexpr int kSweeps = 12;
constexpr int kSweepsToCompare = 4;
constexpr double kTolerance_nats = 1e-3;  // nats
constexpr std::array<int, 4> kOfTheDay{7, 14, 21, 28};
constexpr std::array<int, 3> kOfTheWeek{1, 2, 3};

/// The shares in the middle of each hour of the week, one row an hour.
class HourlyShares {
 public:
  explicit HourlyShares(const PeriodicShares& usual)
      : states_(usual.logit.size()), shares_(kHoursAWeek * states_) {
    for (int hour = 0; hour < kHoursAWeek; ++hour) {
      periodic::shares_at(usual, periodic::middle_of_hour(hour),
                          std::span(shares_).subspan(place(hour), states_));
    }
  }
  [[nodiscard]] std::span<const double> at(std::int64_t hour) const {
    return std::span(shares_).subspan(place(static_cast<int>(hour)), states_);
  }

 private:
  [[nodiscard]] std::size_t place(int hour) const {
    return static_cast<std::size_t>(hour) * states_;
  }
  std::size_t states_;
  std::vector<double> shares_;
};

/// A model of the transitions, as it is fitted.
struct Candidate {
  double rate_per_s = 0.0;
  PeriodicShares usual;
  double log_density = 0.0;  ///< of the transitions and the rate
};

/// Transitions alike: from and to the same likeliest configuration, in one hour of the week, after
/// times alike to a factor of two.
struct Kind {
  double dt_s = 0.0;
  double count = 0.0;
  std::int64_t hour = 0;
  std::vector<double> from;  // looks, in the mean
  std::vector<double> to;
};

void add_to_mean(double value, double weight, double& mean) { mean += weight * (value - mean); }

/// However many years the transitions tell of, there are not more kinds than hours, configurations
/// and lengths of time.
std::vector<Kind> kinds_of(std::span<const std::vector<double>> looks,
                           std::span<const Transition> transitions) {
  using Key = std::tuple<std::size_t, std::size_t, std::int64_t, int>;
  std::map<Key, Kind> kinds;
  for (const Transition& t : transitions) {
    if (t.hour == Transition::kUnknownHour) continue;
    const std::vector<double>& from = looks[t.from];
    const std::vector<double>& to = looks[t.to];
    Kind& kind = kinds[{likeliest(from), likeliest(to), t.hour, std::ilogb(t.dt_s)}];
    kind.hour = t.hour;
    kind.count += t.count;
    kind.from.resize(from.size(), 0.0);
    kind.to.resize(to.size(), 0.0);
    const double weight = t.count / kind.count;
    add_to_mean(t.dt_s, weight, kind.dt_s);
    for (std::size_t k = 0; k < to.size(); ++k) {
      add_to_mean(from[k], weight, kind.from[k]);
      add_to_mean(to[k], weight, kind.to[k]);
    }
  }
  std::vector<Kind> list;
  for (auto& [key, kind] : kinds) list.push_back(std::move(kind));
  return list;
}

/// Fits chains to the transitions of one sub-map.
class Fit {
 public:
  Fit(std::span<const std::vector<double>> looks, const SequenceHistory& history,
      const Chain& chain, const ChainConfig& config)
      : chain_(chain), config_(config), kinds_(kinds_of(looks, history.transitions())) {
    for (const Kind& kind : kinds_) count_ += kind.count;
  }

  /// At a rate for these kinds: who is compared with it has one, too.
  [[nodiscard]] Candidate constant() const {
    Candidate candidate;
    for (const double share : chain_.usual) {
      candidate.usual.logit.push_back(std::log(std::max(share, 1e-12)));
    }
    const std::vector<TransitionOdds> odds = odds_of(HourlyShares(candidate.usual));
    candidate.rate_per_s = most_probable_rate(odds, config_);
    candidate.log_density = log_density_of_rate(odds, candidate.rate_per_s, config_);
    return candidate;
  }

  /// Begun from the chain as slow as it is, and from one that draws anew each time: by their
  /// transitions, the better one.
  [[nodiscard]] Candidate with(std::span<const int> cycles, const Candidate& begin,
                               int sweeps) const {
    Candidate slow = improved(cycles, begin, sweeps);
    if (begin.usual.is_periodic()) return slow;
    Candidate fast = begin;
    fast.rate_per_s = kMaxRate_per_s;
    fast = improved(cycles, std::move(fast), sweeps);
    return fast.log_density > slow.log_density ? fast : slow;
  }

  /// By expectation maximization over which transitions are fresh draws.
  [[nodiscard]] Candidate improved(std::span<const int> cycles, Candidate candidate,
                                   int sweeps) const {
    std::vector<TransitionOdds> odds = odds_of(HourlyShares(candidate.usual));
    for (int sweep = 0; sweep < sweeps; ++sweep) {
      const double before = candidate.log_density;
      candidate.usual =
          periodic::fit_shares(draws(odds, candidate), cycles, config_.amplitude, candidate.usual);
      odds = odds_of(HourlyShares(candidate.usual));
      candidate.rate_per_s = most_probable_rate(odds, config_);
      candidate.log_density = log_density_of_rate(odds, candidate.rate_per_s, config_);
      if (sweep > 0 && candidate.log_density - before < kTolerance_nats) break;
    }
    return candidate;
  }

  /// What so many harmonics must gain [nats].
  [[nodiscard]] double price(std::size_t harmonics) const {
    const double numbers = 2.0 * static_cast<double>(harmonics * (chain_.usual.size() - 1));
    return 0.5 * numbers * std::log(std::max(count_, 2.0));
  }

 private:
  [[nodiscard]] std::vector<TransitionOdds> odds_of(const HourlyShares& usual) const {
    std::vector<TransitionOdds> odds;
    odds.reserve(kinds_.size());
    for (const Kind& kind : kinds_) {
      odds.push_back(odds_of_transition(kind.from, kind.to, chain_.usual, usual.at(kind.hour),
                                        kind.dt_s, kind.count));
    }
    return odds;
  }

  [[nodiscard]] periodic::WeeklySightings draws(std::span<const TransitionOdds> odds,
                                                const Candidate& candidate) const {
    const HourlyShares usual(candidate.usual);
    periodic::WeeklySightings sightings(chain_.usual.size());
    for (int hour = 0; hour < kHoursAWeek; ++hour) {
      for (std::size_t k = 0; k < sightings.states(); ++k) {
        sightings.at(hour, k) = config_.prior_sightings / kHoursAWeek;
      }
    }
    for (std::size_t i = 0; i < kinds_.size(); ++i) {
      const TransitionOdds& one = odds[i];
      const double kept = std::exp(-candidate.rate_per_s * one.dt_s);
      const double drawn = (1.0 - kept) * one.drawn;
      const double all = kept * one.same + drawn;
      if (!(all > 0.0) || !(one.drawn > 0.0)) continue;
      const auto hour = static_cast<int>(kinds_[i].hour);
      const std::span<const double> shares = usual.at(hour);
      const std::vector<double>& look = kinds_[i].to;
      for (std::size_t k = 0; k < look.size(); ++k) {
        sightings.at(hour, k) += one.count * (drawn / all) * look[k] * shares[k] / one.drawn;
      }
    }
    return sightings;
  }

  const Chain& chain_;
  const ChainConfig& config_;
  std::vector<Kind> kinds_;
  double count_ = 0.0;
};

std::vector<int> allowed_cycles(const SeenDays& seen, const ChainConfig& config) {
  std::vector<int> cycles;
  if (seen.days >= config.min_days) cycles.assign(kOfTheDay.begin(), kOfTheDay.end());
  if (seen.weeks >= config.min_weeks)
    cycles.insert(cycles.end(), kOfTheWeek.begin(), kOfTheWeek.end());
  return cycles;
}

}  // namespace

std::optional<ChainInTime> learn_chain_in_time(std::span<const std::vector<double>> looks,
                                               const SequenceHistory& history, const Chain& chain,
                                               const ChainConfig& config) {
  const std::vector<int> allowed = allowed_cycles(history.seen(), config);
  if (chain.usual.size() < 2 || allowed.empty() || config.max_harmonics < 1) return std::nullopt;
  const Fit fit(looks, history, chain, config);
  Candidate best = fit.constant();
  std::vector<int> chosen;
  const auto score_of = [&](const Candidate& candidate, std::size_t harmonics) {
    return candidate.log_density - fit.price(harmonics);
  };
  for (int h = 0; h < config.max_harmonics; ++h) {
    std::optional<Candidate> better;
    int added = 0;
    for (const int cycles : allowed) {
      if (std::find(chosen.begin(), chosen.end(), cycles) != chosen.end()) continue;
      std::vector<int> tried = chosen;
      tried.push_back(cycles);
      Candidate candidate = fit.with(tried, best, kSweepsToCompare);
      const double limit = better ? score_of(*better, tried.size()) : score_of(best, chosen.size());
      if (!(score_of(candidate, tried.size()) > limit)) continue;
      better = std::move(candidate);
      added = cycles;
    }
    if (!better) break;
    chosen.push_back(added);
    best = fit.improved(chosen, std::move(*better), kSweeps);
  }
  if (chosen.empty()) return std::nullopt;
  return ChainInTime{best.rate_per_s, std::move(best.usual)};
}

void follow_time(std::span<const std::vector<double>> looks, const SequenceHistory& history,
                 const ChainConfig& config, Submap& submap) {
  Chain chain{submap.change_rate_per_s, {}};
  for (const Configuration& configuration : submap.configurations) {
    chain.usual.push_back(configuration.prior);
  }
  std::optional<ChainInTime> in_time = learn_chain_in_time(looks, history, chain, config);
  if (!in_time) return;
  submap.change_rate_per_s = in_time->rate_per_s;
  submap.usual = std::move(in_time->usual);
}

}  // namespace strata::patch
