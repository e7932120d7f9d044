// SPDX-License-Identifier: Apache-2.0
#include "core/patch/change_in_view.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include <gtest/gtest.h>

#include "core/patch/contradiction.hpp"
#include "core/patch/online_learner.hpp"
#include "core/patch/patch_learner.hpp"
#include "core/random/stream.hpp"
#include "tests/core/patch/toy_map.hpp"
#include "tests/core/patch/toy_world.hpp"

namespace strata::patch {
namespace {

using test_world::beam;

/// A door 1 m ahead, watched at 5 Hz: how long it is closed, open, closed ...
std::vector<PosedScan> watch(const std::vector<double>& lasts_s) {
  std::vector<PosedScan> scans;
  double at_s = 0.0;
  double until_s = 0.0;
  for (std::size_t i = 0; i < lasts_s.size(); ++i) {
    until_s += lasts_s[i];
    for (; at_s < until_s - 1e-9; at_s += 0.2) scans.push_back(beam(i % 2 == 0 ? 1.0 : 2.0, at_s));
  }
  return scans;
}

std::vector<Visit> visits_of_door(const std::vector<PosedScan>& scans,
                                  const VisitConfig& config = {}) {
  const VisitTable table = find_visits(scans, 0.05, config, {});
  const auto visits = table.at({20, 0});
  return {visits.begin(), visits.end()};
}

TEST(ChangeInView, EndsAVisit) {
  const auto visits = visits_of_door(watch({40.0, 50.0, 60.0}));
  ASSERT_EQ(visits.size(), 3U);
  EXPECT_EQ(visits[0].hits, 200.0F);
  EXPECT_EQ(visits[0].misses, 0.0F);
  EXPECT_EQ(visits[1].first_scan, 200U);
  EXPECT_EQ(visits[1].last_scan, 449U);
  EXPECT_NEAR(visits[1].misses, 250.0F, 1e-2F);
  EXPECT_EQ(visits[2].hits, 300.0F);
}

TEST(ChangeInView, OfLessThanThirtySecondsIsNone) {
  EXPECT_EQ(visits_of_door(watch({60.0, 20.0, 60.0})).size(), 1U) << "somebody lingered";
  EXPECT_EQ(visits_of_door(watch({60.0, 29.0})).size(), 1U) << "who knows how it goes on";
  EXPECT_EQ(visits_of_door(watch({20.0, 60.0})).size(), 1U) << "nor what was there at first";
  const auto visits = visits_of_door(watch({60.0, 20.0, 3.0, 20.0, 60.0}));
  ASSERT_EQ(visits.size(), 1U) << "two who lingered, one after the other";
  EXPECT_EQ(visits[0].hits, 615.0F);
  EXPECT_NEAR(visits[0].misses, 200.0F, 1e-2F) << "nothing is lost";
}

TEST(ChangeInView, MayBeInterruptedByWhoWalksBy) {
  const auto visits = visits_of_door(watch({40.0, 10.0, 1.0, 12.0, 1.0, 40.0}));
  ASSERT_EQ(visits.size(), 2U);
  EXPECT_EQ(visits[1].first_scan, 200U);
  EXPECT_EQ(visits[1].hits, 10.0F);
}

TEST(ChangeInView, IsNotLookedForWhereStatesNeedNotLast) {
  VisitConfig config;
  config.min_state_s = 0.0;
  EXPECT_EQ(visits_of_door(watch({40.0, 50.0, 60.0}), config).size(), 1U);
}

TEST(ChangeInView, OfFewCellsCutsNoSequence) {
  const std::vector<PosedScan> scans = watch({40.0, 50.0});
  const VisitTable table = find_visits(scans, 0.05, {}, {});
  const std::vector<Cell> few(5, Cell{20, 0});
  const std::vector<Cell> enough(6, Cell{20, 0});
  EXPECT_TRUE(changes_in_view(table, few, scans, 0, 10.0).empty());
  EXPECT_EQ(changes_in_view(table, enough, scans, 0, 10.0), (std::vector<std::uint32_t>{200}));
}

TEST(ChangeInView, CutsASequenceWhereEnoughIsLeft) {
  Sequence sequence;
  for (std::uint32_t i = 10; i < 30; ++i) sequence.scans.push_back(i);
  const std::vector<std::uint32_t> changes{5, 20, 28};
  const auto parts = cut_at(sequence, changes, 5);
  ASSERT_EQ(parts.size(), 2U) << "two scans make no sequence";
  EXPECT_EQ(parts[0].scans.front(), 10U);
  EXPECT_EQ(parts[0].scans.back(), 19U);
  EXPECT_EQ(parts[1].scans.front(), 20U);
  EXPECT_EQ(parts[1].scans.back(), 27U);
  EXPECT_EQ(cut_at(sequence, changes, 15)[0].scans.size(), 20U) << "rather whole than gone";
}

TEST(ChangeInView, IsSeenWherePeopleStoodBesideItNowAndThen) {
  // A door of ten cells is closed, then open; people stood 0.1 m before it all the time.
  Grid<std::int32_t> slots(0.05, {{0, 0}, {10, 3}}, -1);
  std::vector<std::uint32_t> offsets{0};
  std::vector<Visit> visits;
  for (int x = 0; x < 10; ++x) {
    for (const int y : {0, 2}) {
      slots.at({x, y}) = static_cast<std::int32_t>(offsets.size()) - 1;
      if (y == 0) visits.push_back({0, 800, 20.0F, 400.0F, {-400.0F, 0.0F}});
      if (y == 2) visits.push_back({0, 399, 100.0F, 0.0F, {}});
      if (y == 2) visits.push_back({400, 800, 0.0F, 100.0F, {-100.0F, 0.0F}});
      offsets.push_back(static_cast<std::uint32_t>(visits.size()));
    }
  }
  const VisitTable table(slots, offsets, visits);
  const Grid<std::uint8_t> found = find_contradictions(table, {});
  for (int x = 0; x < 10; ++x) EXPECT_EQ(found.at({x, 2}), 1) << x;
}

PatchMap learned_at_once(const std::vector<PosedScan>& scans, const ReflectionGrid& base) {
  PatchLearner learner({}, 1);
  for (const PosedScan& scan : scans) learner.add(scan);
  return learner.finish(base);
}

void expect_same(const PatchMap& map, const PatchMap& expected) {
  ASSERT_EQ(map.submaps.size(), expected.submaps.size());
  for (std::size_t s = 0; s < map.submaps.size(); ++s) {
    const Submap& a = map.submaps[s];
    const Submap& b = expected.submaps[s];
    EXPECT_NEAR(a.change_rate_per_s, b.change_rate_per_s, 1e-9);
    ASSERT_EQ(a.sequences.size(), b.sequences.size());
    for (std::size_t i = 0; i < a.sequences.size(); ++i) {
      EXPECT_EQ(a.sequences[i].scans, b.sequences[i].scans) << i;
    }
    ASSERT_EQ(a.configurations.size(), b.configurations.size());
    for (std::size_t k = 0; k < a.configurations.size(); ++k) {
      // Online learners keep counts as floats.
      const ReflectionGrid& m = b.configurations[k].reflection;
      ASSERT_EQ(a.configurations[k].reflection.rect(), m.rect());
      for (std::size_t c = 0; c < m.size(); ++c) {
        const float value = a.configurations[k].reflection.values()[c];
        ASSERT_EQ(is_known(value), is_known(m.values()[c]));
        if (!is_known(value)) continue;
        ASSERT_NEAR(value, m.values()[c], 1e-5F);
      }
    }
  }
}

TEST(ChangeInView, TeachesARobotThatStandsBeforeADoorBothItsStates) {
  const std::vector<PosedScan> scans = test_world::stand_before_door({70.0, 50.0, 110.0, 45.0}, 1);
  const PatchMap map = learned_at_once(scans, test_world::map_of(scans));
  ASSERT_EQ(map.submaps.size(), 1U);
  EXPECT_TRUE(test_world::is_at_door(map.submaps[0], 0.05));
  ASSERT_EQ(map.submaps[0].configurations.size(), 2U);
  EXPECT_GT(map.submaps[0].sequences.size(), 8U);
  for (const SequenceInfo& sequence : map.submaps[0].sequences) {
    EXPECT_GT(std::max(sequence.membership[0], sequence.membership[1]), 0.9)
        << "a sequence of both states";
  }
}

TEST(ChangeInView, IsLearnedAlikeWhileScansCome) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const std::vector<PosedScan> scans =
        test_world::stand_before_door({70.0, 50.0, 110.0, 45.0, 33.0}, seed);
    const ReflectionGrid base = test_world::map_of(scans);
    OnlineConfig online;
    online.extend_base = false;
    OnlinePatchLearner learner({}, online, base, 1);
    std::size_t known_from = 0;
    for (std::size_t i = 0; i < scans.size(); ++i) {
      (void)learner.add(scans[i]);
      if (known_from == 0 && !learner.map().submaps.empty()) known_from = i;
    }
    EXPECT_LT(known_from, 220U) << "30 s after the first change, not when the robot leaves";
    expect_same(learner.finish(), learned_at_once(scans, base));
  }
}

TEST(ChangeInView, GoesOnToTheBitAfterAStop) {
  const std::vector<PosedScan> scans = test_world::stand_before_door({70.0, 50.0, 110.0, 45.0}, 4);
  const ReflectionGrid base = test_world::map_of(scans);
  OnlinePatchLearner whole({}, {}, base, 1);
  auto stopped =
      std::make_unique<OnlinePatchLearner>(PatchLearnerConfig{}, OnlineConfig{}, base, 1);
  for (std::size_t i = 0; i < scans.size(); ++i) {
    (void)whole.add(scans[i]);
    (void)stopped->add(scans[i]);
    if (i % 60 != 50) continue;  // also while a change is not sure yet
    const std::vector<std::uint8_t> state = stopped->save_state();
    stopped = std::make_unique<OnlinePatchLearner>(PatchLearnerConfig{}, OnlineConfig{}, base, 1);
    stopped->restore_state(state, "state");
    EXPECT_EQ(stopped->save_state(), state);
  }
  expect_same(stopped->finish(), whole.finish());
  EXPECT_EQ(stopped->save_state(), whole.save_state());
}

}  // namespace
}  // namespace strata::patch
