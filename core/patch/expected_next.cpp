// SPDX-License-Identifier: Apache-2.0
#include "core/patch/expected_next.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <tuple>

namespace strata::patch {
namespace {

/// A sequence that tells.
struct Seen {
  int run = 0;
  Stamp end;
  std::size_t configuration = 0;
};

/// In the order of runs and time.
std::vector<Seen> seen_in(const Submap& submap) {
  std::vector<Seen> all;
  for (const SequenceInfo& sequence : submap.sequences) {
    const auto likeliest = std::max_element(sequence.membership.begin(), sequence.membership.end());
    if (likeliest == sequence.membership.end() || *likeliest <= 0.5) continue;
    all.push_back({sequence.run, sequence.end,
                   static_cast<std::size_t>(likeliest - sequence.membership.begin())});
  }
  std::sort(all.begin(), all.end(), [](const Seen& a, const Seen& b) {
    return std::tie(a.run, a.end) < std::tie(b.run, b.end);
  });
  return all;
}

/// The cells that are an obstacle in one of two configurations and free in the other.
std::size_t difference(const Configuration& a, const Configuration& b) {
  const auto one = a.reflection.values();
  const auto other = b.reflection.values();
  std::size_t cells = 0;
  for (std::size_t i = 0; i < one.size(); ++i) {
    if (!is_known(one[i]) || !is_known(other[i])) continue;
    if (is_occupied(one[i]) != is_occupied(other[i])) ++cells;
  }
  return cells;
}

/// The sequences of the last runs.
std::span<const Seen> last_runs(std::span<const Seen> seen) {
  int runs = 0;
  for (std::size_t i = seen.size(); i-- > 0;) {
    const bool begins_run = i + 1 == seen.size() || seen[i + 1].run != seen[i].run;
    if (begins_run && ++runs > kRunsAsked) return seen.subspan(i + 1);
  }
  return seen;
}

std::size_t expected_of(const Submap& submap) {
  const auto& all = submap.configurations;
  const std::vector<Seen> every = seen_in(submap);
  const std::span<const Seen> seen = last_runs(every);
  std::vector<std::size_t> counts(all.size(), 0);
  for (const Seen& one : seen) ++counts[one.configuration];
  std::size_t best = 0;
  std::optional<std::size_t> least;
  for (std::size_t i = seen.size(); i-- > 0;) {  // the one seen last first
    const std::size_t candidate = seen[i].configuration;
    std::size_t cells = 0;
    for (std::size_t c = 0; c < all.size(); ++c) {
      if (counts[c] > 0) cells += counts[c] * difference(all[candidate], all[c]);
    }
    if (least && cells >= *least) continue;
    least = cells;
    best = candidate;
  }
  if (least) return best;
  const auto by_prior = [](const Configuration& a, const Configuration& b) {
    return a.prior < b.prior;
  };
  return static_cast<std::size_t>(std::max_element(all.begin(), all.end(), by_prior) - all.begin());
}

}  // namespace

std::vector<int> expected_next(const PatchMap& map) {
  std::vector<int> chosen;
  for (const Submap& submap : map.submaps) chosen.push_back(static_cast<int>(expected_of(submap)));
  return chosen;
}

}  // namespace strata::patch
