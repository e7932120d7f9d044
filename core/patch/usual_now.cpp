// SPDX-License-Identifier: Apache-2.0
#include "core/patch/usual_now.hpp"

#include <algorithm>
#include <cstddef>
#include <map>
#include <tuple>
#include <utility>

namespace strata::patch {
namespace {

/// A sequence that tells, in the order of runs and time.
struct Seen {
  int run = 0;
  Stamp end;
  std::size_t configuration = 0;
};

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

/// From where on nothing is seen that was seen before, and for long enough; seen.size(): nowhere.
std::size_t settled_from(const std::vector<Seen>& seen, std::size_t configurations) {
  std::vector<std::size_t> first(configurations, seen.size());
  for (std::size_t i = seen.size(); i-- > 0;) first[seen[i].configuration] = i;
  std::size_t oldest = seen.size();  // where what is seen from here on was first seen
  int runs = 0;
  for (std::size_t i = seen.size(); i-- > 1;) {
    if (i + 1 == seen.size() || seen[i + 1].run != seen[i].run) ++runs;
    oldest = std::min(oldest, first[seen[i].configuration]);
    if (runs >= kRunsToSettle && oldest == i) return i;
  }
  return seen.size();
}

std::size_t usual_of(const Submap& submap) {
  const auto by_prior = [](const Configuration& a, const Configuration& b) {
    return a.prior < b.prior;
  };
  const auto& all = submap.configurations;
  const std::vector<Seen> seen = seen_in(submap);
  const std::size_t from = settled_from(seen, all.size());
  if (from == seen.size()) {
    return static_cast<std::size_t>(std::max_element(all.begin(), all.end(), by_prior) -
                                    all.begin());
  }
  std::map<std::size_t, std::pair<std::size_t, std::size_t>> counts;  // how often, and where last
  for (std::size_t i = from; i < seen.size(); ++i) {
    auto& [count, last] = counts[seen[i].configuration];
    ++count;
    last = i;
  }
  return std::max_element(counts.begin(), counts.end(),
                          [](const auto& a, const auto& b) { return a.second < b.second; })
      ->first;
}

}  // namespace

std::vector<int> usual_now(const PatchMap& map) {
  std::vector<int> chosen;
  for (const Submap& submap : map.submaps) chosen.push_back(static_cast<int>(usual_of(submap)));
  return chosen;
}

}  // namespace strata::patch
