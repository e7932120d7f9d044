// SPDX-License-Identifier: Apache-2.0
/// Boxes that return, and boxes that never do.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/damage.hpp"
#include "core/patch/online_learner.hpp"
#include "core/patch/patch_learner.hpp"
#include "tests/core/patch/box_world.hpp"
#include "tests/core/patch/toy_map.hpp"

namespace strata::patch {
namespace {

constexpr double kCell_m = 0.05;

PatchMap learn_boxes(const std::vector<PosedScan>& scans, const PatchLearnerConfig& config = {}) {
  PatchLearner learner(config);
  for (const PosedScan& scan : scans) learner.add(scan);
  return learner.finish(test_world::map_of(scans));
}

std::vector<PosedScan> visits(const std::vector<int>& places, std::uint64_t seed) {
  return test_world::drive_past_box(places, seed, test_world::Visits::kRuns);
}

// [stachniss2005patch, figure 3].
TEST(RecurringBoxes, ABoxAtThreePlacesIsOneSubmapWithThreeConfigurations) {
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    const std::vector<int> places{0, 1, 2, 0, 1, 2};
    const PatchMap map = learn_boxes(visits(places, seed));
    ASSERT_EQ(map.submaps.size(), 1U) << "seed " << seed;
    const Submap& submap = map.submaps[0];
    EXPECT_LE(static_cast<double>(submap.rect.area()) * kCell_m * kCell_m, 20.0);
    ASSERT_EQ(submap.configurations.size(), 3U) << "seed " << seed;
    for (const SequenceInfo& a : submap.sequences) {
      for (const SequenceInfo& b : submap.sequences) {
        double overlap = 0.0;
        for (std::size_t c = 0; c < 3; ++c) overlap += a.membership[c] * b.membership[c];
        EXPECT_EQ(overlap > 0.5, places[static_cast<std::size_t>(a.run)] ==
                                     places[static_cast<std::size_t>(b.run)])
            << "seed " << seed << " runs " << a.run << " " << b.run;
      }
    }
  }
}

TEST(RecurringBoxes, ABoxThatIsSometimesAbsentAddsAFourthConfiguration) {
  const PatchMap map = learn_boxes(visits({0, 1, 2, -1, 0, 1, 2, -1}, 5));
  ASSERT_EQ(map.submaps.size(), 1U);
  EXPECT_EQ(map.submaps[0].configurations.size(), 4U);
}

/// A box at a new place with each drive, and at the end none.
const std::vector<int> kAlwaysNew{0, 1, 2, 3, 4, -1};

// Boxes that never return say where boxes will not be: a filter that knows them takes the next box
// for one of them.
TEST(RecurringBoxes, ABoxThatIsSomewhereElseEachTimeMakesNoSubmapButIsNamed) {
  const std::vector<PosedScan> scans = visits(kAlwaysNew, 2);
  const PatchMap map = learn_boxes(scans);
  EXPECT_TRUE(map.submaps.empty());
  ASSERT_FALSE(map.unrecurring.empty());
  EXPECT_TRUE(map.unrecurring[0].contains(map.base.cell_at({4.8, 0.5})));

  PatchLearnerConfig all;
  all.recurrence.min_probability = 0.0;
  const PatchMap as_printed = learn_boxes(scans, all);
  EXPECT_EQ(as_printed.submaps.size(), map.unrecurring.size());
  EXPECT_TRUE(as_printed.unrecurring.empty());
  for (const Submap& submap : as_printed.submaps) EXPECT_GE(submap.configurations.size(), 2U);
}

// While scans come: at first it may yet return, then it never has, and at last it does.
TEST(RecurringBoxes, AreLeftOutWhileScansComeUntilTheyReturn) {
  std::vector<int> places = kAlwaysNew;
  places.insert(places.end(), {0, -1, 1, -1, 2, -1, 3, -1, 4, -1});
  const std::vector<PosedScan> scans =
      test_world::drive_past_box(places, 2, test_world::Visits::kOneRun);
  OnlinePatchLearner learner({}, {}, test_world::map_of(scans));
  const std::size_t of_each = scans.size() / places.size();
  std::vector<std::size_t> submaps;
  std::vector<std::size_t> left_out;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    (void)learner.add(scans[i]);
    if ((i + 1) % of_each != 0) continue;
    const PatchMap map = learner.map();
    submaps.push_back(map.submaps.size());
    left_out.push_back(map.unrecurring.size());
  }
  EXPECT_GT(submaps[3], 0U) << "few visits are no reason to doubt";
  EXPECT_EQ(submaps[kAlwaysNew.size()], 0U);
  EXPECT_GT(left_out[kAlwaysNew.size()], 0U);
  EXPECT_GT(submaps.back(), 0U);
  EXPECT_EQ(left_out.back(), 0U);
}

TEST(RecurringBoxes, ASavedCountOfThemThatIsDamagedIsRefused) {
  PatchLearnerConfig all;
  all.recurrence.min_probability = 0.0;
  const std::vector<PosedScan> scans =
      test_world::drive_past_box(kAlwaysNew, 2, test_world::Visits::kOneRun);
  const ReflectionGrid base = test_world::map_of(scans);
  OnlinePatchLearner learner(all, {}, base);
  for (const PosedScan& scan : scans) (void)learner.add(scan);
  const Recurrence seen = learner.finish().submaps.at(0).recurrence;
  ASSERT_GT(seen.appearances, 1.0);
  const double wanted[] = {seen.appearances, seen.kinds};
  const std::vector<std::uint8_t> state = learner.save_state();
  const auto* first = reinterpret_cast<const std::uint8_t*>(wanted);
  const auto found = std::search(state.begin(), state.end(), first, first + sizeof(wanted));
  ASSERT_NE(found, state.end());
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  for (const auto& [appearances, kinds] : {std::pair{kNone, 1.0}, {1.0, kNone}, {1.0, 2.0}}) {
    const double damaged[] = {appearances, kinds};
    std::vector<std::uint8_t> bytes = state;
    std::memcpy(bytes.data() + (found - state.begin()), damaged, sizeof(damaged));
    OnlinePatchLearner other(all, {}, base);
    EXPECT_THROW(other.restore_state(bytes, "state"), DamageError) << appearances << " " << kinds;
  }
}

}  // namespace
}  // namespace strata::patch
