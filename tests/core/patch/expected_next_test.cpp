// SPDX-License-Identifier: Apache-2.0
#include "core/patch/expected_next.hpp"

#include <algorithm>
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

int expected(const std::vector<std::vector<int>>& runs,
             std::vector<double> priors = {0.6, 0.3, 0.1}) {
  return expected_next(map_of(runs, std::move(priors))).front();
}

TEST(ExpectedNext, IsTheGreatestPriorWhereThingsMoveToAndFro) {
  EXPECT_EQ(expected({}), 0);
  EXPECT_EQ(expected({{1}}), 0);
  EXPECT_EQ(expected({{0}, {1}, {0}, {1}, {0}, {1}}), 0);
  EXPECT_EQ(expected({{0}, {1}, {0}, {1}, {0}, {1}}, {0.3, 0.7}), 1);
  EXPECT_EQ(expected({{0}, {0}, {0}, {0}, {1}, {0}, {0}, {1}}), 0);
}

TEST(ExpectedNext, IsWhatWasSeenLastWhereThingsMoveForGood) {
  EXPECT_EQ(expected({{0}, {0}, {0}, {0}, {1}}), 0) << "one run may be chance";
  EXPECT_EQ(expected({{0}, {0}, {0}, {0}, {1}, {1}}), 1);
  EXPECT_EQ(expected({{0}, {0}, {0}, {0}, {1}, {1}, {0}}), 0) << "it is back";
  EXPECT_EQ(expected({{0}, {0}, {0}, {0}, {1}, {2}, {2}, {1}, {1}}), 1) << "beside a door";
  EXPECT_EQ(expected({{0}, {0}, {0, 1}, {1}}), 1) << "it was moved in view";
  EXPECT_EQ(expected({{0}, {0}, {1}, {-1}, {1}}), 1) << "what does not tell says nothing";
  // What was guessed long ago says nothing of today.
  std::vector<std::vector<int>> runs(20, std::vector<int>{0});
  for (const int seen : {1, 1, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0}) runs.push_back({seen});
  EXPECT_EQ(expected(runs, {0.4, 0.6}), 1) << "to and fro again: the prior";
}

/// Of doors that are drawn anew every day, and of a cabinet that is moved once: how often what was
/// expected came, of what the prior says and of what was seen last. It takes some days to tell.
TEST(ExpectedNext, IsNearlyAsOftenRightAsTheBetterOfBothGuesses) {
  RandomStream random(5, StreamId::kTest);
  for (const bool is_moved : {false, true}) {
    int right = 0;
    int prior_right = 0;
    int last_right = 0;
    for (int trial = 0; trial < 400; ++trial) {
      std::vector<std::vector<int>> runs;
      int open = 0;
      for (int day = 0; day < 40; ++day) {
        const bool is_open = random.bernoulli(0.3);
        const int cabinet = is_moved && day >= 25 ? 2 : 0;
        if (day > 20) {
          const double share = static_cast<double>(open) / day;
          std::vector<double> priors(4, 0.0);
          for (const auto& run : runs) priors[static_cast<std::size_t>(run[0])] += 1.0 / day;
          ASSERT_NEAR(priors[1] + priors[3], share, 1e-9);
          const int prior =
              static_cast<int>(std::max_element(priors.begin(), priors.end()) - priors.begin());
          const int now = cabinet + (is_open ? 1 : 0);
          right += expected(runs, priors) == now ? 1 : 0;
          prior_right += prior == now ? 1 : 0;
          last_right += runs.back()[0] == now ? 1 : 0;
        }
        runs.push_back({cabinet + (is_open ? 1 : 0)});
        open += is_open ? 1 : 0;
      }
    }
    const int better = std::max(prior_right, last_right);
    EXPECT_GT(right, 0.85 * better)
        << is_moved << " " << right << " " << prior_right << " " << last_right;
    EXPECT_GT(right, 1.1 * std::min(prior_right, last_right));
  }
}

}  // namespace
}  // namespace strata::patch
