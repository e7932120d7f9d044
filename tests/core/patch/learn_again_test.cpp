// SPDX-License-Identifier: Apache-2.0
/// Patches of scans whose poses became known better after they were learned.
#include "core/patch/learn_again.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "core/patch/patch_learner.hpp"
#include "tests/core/patch/toy_map.hpp"
#include "tests/core/patch/toy_world.hpp"

namespace strata::patch {
namespace {

constexpr std::uint64_t kSeed = 21;

/// Past a door that is closed and open in turn, each drive with an error of pose of its own.
std::vector<PosedScan> drives(double error_m) {
  return test_world::drive_past_door({true, false, true, false, true, false}, error_m, 0.0, kSeed,
                                     test_world::Visits::kOneRun);
}

PatchMap learned(const std::vector<PosedScan>& scans, const ReflectionGrid& base) {
  PatchLearner learner{PatchLearnerConfig{}};
  for (const PosedScan& scan : scans) learner.add(scan);
  return learner.finish(base);
}

/// A sub-map over those cells, learned from scans of that time.
Submap area(const CellRect& rect, double begin_s, double end_s, std::size_t scans) {
  Submap submap;
  submap.rect = rect;
  submap.contradictory = Grid<std::uint8_t>(0.05, rect, 1);
  for (const float value : {0.0F, 1.0F}) {
    submap.configurations.push_back(
        {Grid<CellCounts>(0.05, rect), ReflectionGrid(0.05, rect, value), 0.5});
  }
  submap.sequences.push_back(
      {0, Stamp::from_seconds(begin_s), Stamp::from_seconds(end_s), scans, {0.5, 0.5}});
  return submap;
}

TEST(LearnAgain, GivesThePatchesThatTheRightPosesWouldHaveGivenAtOnce) {
  const auto bent = drives(0.25);
  const auto right = drives(0.0);
  const PatchMap before = learned(bent, test_world::map_of(bent));
  ASSERT_FALSE(before.submaps.empty());
  const ReflectionGrid base = test_world::map_of(right);
  const PatchMap wanted = learned(right, base);
  ASSERT_EQ(wanted.submaps.size(), 1U);
  ASSERT_FALSE(before.submaps[0].rect == wanted.submaps[0].rect);

  const LearnedAgain again = learn_again(before, right, base, {});
  EXPECT_EQ(again.stayed, 0U);
  ASSERT_EQ(again.map.submaps.size(), 1U);
  EXPECT_TRUE(test_world::is_at_door(again.map.submaps[0], 0.05));
  EXPECT_EQ(again.map.submaps[0].rect, wanted.submaps[0].rect);
  EXPECT_EQ(again.map.submaps[0].configurations.size(), wanted.submaps[0].configurations.size());
  EXPECT_EQ(again.map.base.rect(), base.rect()) << "nothing of the bent base is left";
}

TEST(LearnAgain, LeavesWhatRestsOnScansThatAreNotThere) {
  const auto right = drives(0.0);
  const ReflectionGrid base = test_world::map_of(right);
  PatchMap before;
  before.base = base;
  const CellRect far{{10, -40}, {20, -30}};
  before.base.grow(far);
  before.base.at(far.min) = 0.0F;
  before.submaps = {area(far, -500.0, -400.0, 30),                // long forgotten
                    area({{100, 5}, {110, 15}}, 0.0, 50.0, 30)};  // can be learned, and is nothing
  const LearnedAgain again = learn_again(before, right, base, {});
  EXPECT_EQ(again.stayed, 1U);
  ASSERT_EQ(again.map.submaps.size(), 2U);
  EXPECT_EQ(again.map.submaps[0].rect, far);
  EXPECT_TRUE(test_world::is_at_door(again.map.submaps[1], 0.05));
  EXPECT_EQ(again.map.submaps[1].id, 1);
  EXPECT_EQ(again.map.base.get(far.min), 0.0F) << "what is known around it";
}

TEST(LearnAgain, PutsNothingNewWhereAnOldAreaStays) {
  const auto right = drives(0.0);
  const ReflectionGrid base = test_world::map_of(right);
  const PatchMap wanted = learned(right, base);
  ASSERT_EQ(wanted.submaps.size(), 1U);
  PatchMap before;
  before.base = base;
  // Mostly of scans that are gone.
  const std::size_t many = 3 * right.size();
  before.submaps = {area(wanted.submaps[0].rect.inflated(5), 0.0, 10'000.0, many)};
  const LearnedAgain again = learn_again(before, right, base, {});
  EXPECT_EQ(again.stayed, 1U);
  ASSERT_EQ(again.map.submaps.size(), 1U);
  EXPECT_EQ(again.map.submaps[0].rect, before.submaps[0].rect);
}

}  // namespace
}  // namespace strata::patch
