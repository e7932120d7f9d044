// SPDX-License-Identifier: Apache-2.0
#include "core/patch/usual_now.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/random/stream.hpp"

namespace strata::patch {
namespace {

/// One area; of each run the configurations that it saw, -1 for a look that does not tell.
PatchMap map_of(const std::vector<std::vector<int>>& runs, std::vector<double> priors) {
  PatchMap map;
  Submap& submap = map.submaps.emplace_back();
  for (const double prior : priors) submap.configurations.emplace_back().prior = prior;
  std::int64_t end_ns = 0;
  for (std::size_t run = 0; run < runs.size(); ++run) {
    for (const int seen : runs[run]) {
      SequenceInfo& sequence = submap.sequences.emplace_back();
      sequence.run = static_cast<int>(run);
      sequence.end.ns = ++end_ns;
      sequence.membership.assign(priors.size(), 1.0 / static_cast<double>(priors.size()));
      if (seen >= 0) {
        sequence.membership.assign(priors.size(), 0.0);
        sequence.membership[static_cast<std::size_t>(seen)] = 1.0;
      }
    }
  }
  return map;
}

int usual(const std::vector<std::vector<int>>& runs, std::vector<double> priors = {0.6, 0.3, 0.1}) {
  return usual_now(map_of(runs, std::move(priors))).front();
}

TEST(UsualNow, IsTheGreatestPriorWhereThingsComeBack) {
  EXPECT_EQ(usual({}), 0);
  EXPECT_EQ(usual({{1}}), 0);
  EXPECT_EQ(usual({{0}, {1}, {0}, {1}, {1}, {1}}), 0);
  EXPECT_EQ(usual({{0}, {1}, {0}, {1}, {1}, {1}}, {0.3, 0.7}), 1);
}

TEST(UsualNow, IsWhatStandsThereSinceItChangedForGood) {
  EXPECT_EQ(usual({{0}, {0}, {0}, {0}, {1}, {1}}), 0) << "two runs may be chance";
  EXPECT_EQ(usual({{0}, {0}, {0}, {0}, {1}, {1}, {1}}), 1);
  EXPECT_EQ(usual({{0}, {0}, {0}, {0}, {1}, {1}, {0}}), 0) << "it is back";
  EXPECT_EQ(usual({{0}, {0}, {1}, {2}, {2}, {1}, {2}}), 2) << "a door beside it goes on moving";
  EXPECT_EQ(usual({{0}, {0}, {1}, {2}, {1}, {2}}), 2) << "as often, and later";
  EXPECT_EQ(usual({{0}, {0}, {1}, {-1}, {1}, {1}}), 1) << "what does not tell says nothing";
  EXPECT_EQ(usual({{0, 0, 0}, {0, 1, 1, 1}}), 0) << "within a run nothing settles";
  EXPECT_EQ(usual({{0}, {0, 1}, {1}, {1}, {1}}), 1) << "it was moved in view, and three runs agree";
}

/// The same from the words of its header, tried from every sequence on.
int slow_usual(const std::vector<std::vector<int>>& runs, const std::vector<double>& priors) {
  std::vector<std::pair<std::size_t, int>> told;  // of which run, and what
  for (std::size_t run = 0; run < runs.size(); ++run) {
    for (const int seen : runs[run]) {
      if (seen >= 0) told.emplace_back(run, seen);
    }
  }
  for (std::size_t from = told.size(); from-- > 1;) {
    std::set<int> before;
    std::set<int> after;
    std::set<std::size_t> runs_after;
    std::map<int, std::pair<int, std::size_t>> counts;
    for (std::size_t i = 0; i < told.size(); ++i) {
      const auto& [run, seen] = told[i];
      (i < from ? before : after).insert(seen);
      if (i < from) continue;
      runs_after.insert(run);
      counts[seen] = {counts[seen].first + 1, i};
    }
    const bool is_other =
        std::none_of(after.begin(), after.end(), [&](int seen) { return before.contains(seen); });
    if (!is_other || runs_after.size() < kRunsToSettle) continue;
    std::pair<std::pair<int, std::size_t>, int> best;
    for (const auto& [seen, count] : counts) best = std::max(best, {count, seen});
    return best.second;
  }
  return static_cast<int>(std::max_element(priors.begin(), priors.end()) - priors.begin());
}

TEST(UsualNow, IsThatOfASlowReference) {
  RandomStream random(3, StreamId::kTest);
  int settled = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const std::size_t kinds = 2 + random.below(4);
    std::vector<double> priors(kinds);
    for (double& prior : priors) prior = random.uniform();
    std::vector<std::vector<int>> runs(1 + random.below(10));
    for (std::size_t run = 0; run < runs.size(); ++run) {
      runs[run].resize(random.below(3));
      for (int& seen : runs[run]) {
        // Later runs see later kinds, mostly.
        const auto low = static_cast<std::uint32_t>(run * (kinds - 1) / runs.size());
        seen = random.bernoulli(0.1)
                   ? -1
                   : static_cast<int>(std::min<std::size_t>(kinds - 1, low + random.below(2)));
      }
    }
    const int expected = slow_usual(runs, priors);
    ASSERT_EQ(usual(runs, priors), expected) << trial;
    settled += expected != slow_usual({}, priors) ? 1 : 0;
  }
  EXPECT_GT(settled, 100);
}

}  // namespace
}  // namespace strata::patch
