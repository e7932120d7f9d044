// SPDX-License-Identifier: Apache-2.0
#include "core/scan/drop_out_tally.hpp"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

namespace strata {
namespace {

/// Beams that judge a scanner, without return and with one; and each of its distances.
constexpr std::uint64_t kMinJudged = 100;
constexpr std::uint64_t kMinReturned = 200;
constexpr std::uint64_t kMinBinJudged = 30;
/// Far returns a beam without return. Along a corridor there are 0.34, whatever its width and the
/// reach: arcs of asin(w / r). Where a building ends long before the reach there are none, and what
/// returns nothing is dark, of glass or slanted, however seldom the scans around say so.
constexpr double kMinFar = 0.05;

std::uint64_t sum_of(const std::array<std::uint64_t, DropOutTally::kBins>& counts) {
  return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
}

/// Neighbouring bins, up to `end`.
struct Stretch {
  std::uint64_t met = 0;
  std::uint64_t dropped = 0;
  std::size_t end = 0;
};

/// Stretches in which returns drop out ever more often, the nearest first (pool adjacent
/// violators): the further away the fainter. What moves nearby, such as legs, looks like a surface
/// that lost its return; there are few of it.
std::vector<Stretch> by_distance(const std::array<std::uint64_t, DropOutTally::kBins>& met,
                                 const std::array<std::uint64_t, DropOutTally::kBins>& dropped) {
  std::vector<Stretch> stretches;
  Stretch next;
  for (std::size_t bin = 0; bin < DropOutTally::kBins; ++bin) {
    next = {next.met + met[bin], next.dropped + dropped[bin], bin + 1};
    if (next.met < kMinBinJudged) continue;
    while (!stretches.empty() &&
           stretches.back().dropped * next.met >= next.dropped * stretches.back().met) {
      next = {next.met + stretches.back().met, next.dropped + stretches.back().dropped, next.end};
      stretches.pop_back();
    }
    stretches.push_back(std::exchange(next, {}));
  }
  return stretches;
}

bool is_share_above(std::uint64_t part, std::uint64_t whole, double share) {
  return static_cast<double>(part) > share * static_cast<double>(whole);
}

}  // namespace

void DropOutTally::add(const DropOutTally& other) {
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    met_[bin] += other.met_[bin];
    dropped_[bin] += other.dropped_[bin];
  }
  no_returns_ += other.no_returns_;
  far_ += other.far_;
}

double DropOutTally::free_range_m(double reach_m, const NoReturnConfig& config) const {
  const std::uint64_t dropped = sum_of(dropped_);
  if (no_returns_ < kMinJudged || sum_of(met_) - dropped < kMinReturned) return 0.0;
  if (is_share_above(dropped, no_returns_, config.max_drop_out_share)) return 0.0;
  if (!is_share_above(far_, no_returns_, kMinFar)) return 0.0;
  double share = 0.0;  // of the reach, up to which returns are known to drop out seldom
  bool is_often = false;
  for (const Stretch& stretch : by_distance(met_, dropped_)) {
    is_often = is_share_above(stretch.dropped, stretch.met, config.max_drop_out_rate);
    if (is_often) break;
    share = static_cast<double>(stretch.end) / static_cast<double>(kBins);
  }
  // Nowhere often: then also where too few beams tell.
  share = is_often ? std::min(share, kTrusted) : kTrusted;
  return std::min(share * reach_m, config.max_free_range_m);
}

void DropOutTally::report(DropOuts& sum) const {
  sum.no_returns += no_returns_;
  sum.dropped += sum_of(dropped_);
  sum.returned += sum_of(met_) - sum_of(dropped_);
}

}  // namespace strata
