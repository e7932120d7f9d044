// SPDX-License-Identifier: Apache-2.0
#include "core/patch/expected_next.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace strata::patch {
namespace {

/// A door of two cells and a shelf of three in a row: configuration 0 has neither, 1 the door
/// closed, 2 the shelf, 3 both; of each run the configurations that it saw, -1 for a look that does
/// not tell.
PatchMap map_of(const std::vector<std::vector<int>>& runs, const std::vector<double>& priors) {
  PatchMap map;
  Submap& submap = map.submaps.emplace_back();
  submap.rect = {{0, 0}, {6, 1}};
  for (std::size_t c = 0; c < priors.size(); ++c) {
    Configuration& configuration = submap.configurations.emplace_back();
    configuration.prior = priors[c];
    configuration.reflection = ReflectionGrid(0.05, submap.rect, 0.0F);
    for (int x = 0; x < 5; ++x) {
      const bool is_there = x < 2 ? c % 2 == 1 : c >= 2;
      configuration.reflection.at({x, 0}) = is_there ? 1.0F : 0.0F;
    }
    if (c == 1) configuration.reflection.at({5, 0}) = kUnknownReflection;
  }
  std::int64_t end_ns = 0;
  for (std::size_t run = 0; run < runs.size(); ++run) {
    for (const int seen : runs[run]) {
      SequenceInfo& sequence = submap.sequences.emplace_back();
      sequence.run = static_cast<int>(run);
      sequence.end.ns = ++end_ns;
      sequence.membership.assign(priors.size(), 1.0 / static_cast<double>(priors.size()));
      if (seen < 0) continue;
      sequence.membership.assign(priors.size(), 0.0);
      sequence.membership[static_cast<std::size_t>(seen)] = 1.0;
    }
  }
  return map;
}

int expected(const std::vector<std::vector<int>>& runs,
             const std::vector<double>& priors = {0.4, 0.3, 0.2, 0.1}) {
  return expected_next(map_of(runs, priors)).front();
}

TEST(ExpectedNext, IsTheGreatestPriorWhereNothingTells) {
  EXPECT_EQ(expected({}), 0);
  EXPECT_EQ(expected({}, {0.1, 0.2, 0.4, 0.3}), 2);
  EXPECT_EQ(expected({{-1}, {-1}}, {0.1, 0.2, 0.4, 0.3}), 2);
}

TEST(ExpectedNext, IsWhereAThingMostlyIsThatMovesToAndFro) {
  EXPECT_EQ(expected({{0}, {1}, {0}, {1}, {0}}), 0);
  EXPECT_EQ(expected({{0}, {1}, {0}, {1}, {1}}), 1);
  EXPECT_EQ(expected({{0}, {1}}), 1) << "as often, and later";
  EXPECT_EQ(expected({{0}, {0}, {0}, {1}, {0}, {0}, {0}, {1}}), 0);
}

TEST(ExpectedNext, IsWhatWasMovedForGoodAfterThreeRuns) {
  EXPECT_EQ(expected({{0}, {0}, {0}, {0}, {2}}), 0) << "one run may be chance";
  EXPECT_EQ(expected({{0}, {0}, {0}, {0}, {2}, {2}}), 0);
  EXPECT_EQ(expected({{0}, {0}, {0}, {0}, {2}, {2}, {2}}), 2);
  EXPECT_EQ(expected({{2}, {2}, {2}, {2}, {0}, {0}, {0}}), 0) << "taken away";
  // Whatever the door beside the shelf does: every way of it in eight runs.
  for (int doors = 0; doors < 256; ++doors) {
    std::vector<std::vector<int>> runs;
    for (int run = 0; run < 8; ++run) {
      runs.push_back({(run >= 5 ? 2 : 0) + ((doors >> run) & 1)});
    }
    EXPECT_GE(expected(runs), 2) << doors;
    runs.pop_back();
    EXPECT_LT(expected(runs), 2) << doors;
  }
}

TEST(ExpectedNext, CountsWhatARunSawOfAMove) {
  EXPECT_EQ(expected({{0}, {0}, {0}, {0, 2, 2}, {2}, {2}}), 2) << "it was moved in view";
  EXPECT_EQ(expected({{0}, {0}, {2}, {-1}, {2}, {2}}), 2) << "what does not tell says nothing";
}

}  // namespace
}  // namespace strata::patch
