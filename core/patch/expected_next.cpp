// SPDX-License-Identifier: Apache-2.0
#include "core/patch/expected_next.hpp"

#include <algorithm>
#include <cstddef>
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

/// How often a configuration was seen so far, and where last: the more usual one is greater.
struct Sightings {
  std::size_t count = 0;
  std::size_t last = 0;
  friend auto operator<=>(const Sightings&, const Sightings&) = default;
};

/// Of one run, which guesses were right.
struct Guesses {
  bool last = false;
  bool usual = false;
};

std::vector<Guesses> guesses_of(const std::vector<Seen>& seen, std::size_t configurations) {
  std::vector<Sightings> sightings(configurations);
  std::vector<Guesses> guesses;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (i > 0 && seen[i].run != seen[i - 1].run) {
      const auto usual = std::max_element(sightings.begin(), sightings.end()) - sightings.begin();
      guesses.push_back({seen[i].configuration == seen[i - 1].configuration,
                         seen[i].configuration == static_cast<std::size_t>(usual)});
    }
    Sightings& here = sightings[seen[i].configuration];
    here = {here.count + 1, i};
  }
  return guesses;
}

std::size_t expected_of(const Submap& submap) {
  const auto& all = submap.configurations;
  const std::vector<Seen> seen = seen_in(submap);
  const std::vector<Guesses> guesses = guesses_of(seen, all.size());
  const auto begin =
      guesses.end() - static_cast<std::ptrdiff_t>(std::min(kGuessedRuns, guesses.size()));
  const auto last =
      std::count_if(begin, guesses.end(), [](const Guesses& guess) { return guess.last; });
  const auto usual =
      std::count_if(begin, guesses.end(), [](const Guesses& guess) { return guess.usual; });
  if (last > usual) return seen.back().configuration;
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
