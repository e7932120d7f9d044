// SPDX-License-Identifier: Apache-2.0
#include "core/patch/online_learner.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/patch/patch_learner.hpp"
#include "core/random/stream.hpp"
#include "tests/core/patch/toy_map.hpp"
#include "tests/core/patch/toy_world.hpp"
#include "tests/support/same_bits.hpp"

namespace strata::patch {
namespace {

using strata::test::same_bits;

constexpr double kResolution = 0.05;
constexpr double kDegree = 3.14159265358979323846 / 180.0;

/// One long run: a robot at work.
std::vector<PosedScan> working_day(const std::vector<bool>& closed, double position_stddev_m,
                                   double heading_stddev_rad, std::uint64_t seed) {
  return test_world::drive_past_door(closed, position_stddev_m, heading_stddev_rad, seed,
                                     test_world::Visits::kOneRun);
}

std::vector<bool> now_and_then(std::size_t visits, std::uint64_t seed) {
  std::vector<bool> closed;
  RandomStream random(seed, StreamId::kTest, 999);
  for (std::size_t v = 0; v < visits; ++v)
    closed.push_back(v < 4 ? v % 2 == 0 : random.bernoulli(0.5));
  return closed;
}

PatchMap batch(const std::vector<PosedScan>& scans, const ReflectionGrid& base) {
  PatchLearner learner({}, 1);
  for (const PosedScan& scan : scans) learner.add(scan);
  return learner.finish(base);
}

bool is_at_door(const Submap& submap) { return test_world::is_at_door(submap, kResolution); }

/// The same configurations to the bit.
void expect_same(const PatchMap& map, const PatchMap& expected) {
  ASSERT_EQ(map.submaps.size(), expected.submaps.size());
  for (std::size_t s = 0; s < map.submaps.size(); ++s) {
    const auto& configurations = map.submaps[s].configurations;
    ASSERT_EQ(configurations.size(), expected.submaps[s].configurations.size());
    for (std::size_t k = 0; k < configurations.size(); ++k) {
      EXPECT_TRUE(same_bits(configurations[k].reflection,
                            expected.submaps[s].configurations[k].reflection));
    }
  }
}

/// How far two maps are apart: the number of sub-maps and configurations must agree, rectangles to
/// the cell, and grids by the root mean square given back.
double distance(const PatchMap& a, const PatchMap& b) {
  EXPECT_EQ(a.submaps.size(), b.submaps.size());
  double squared = 0.0;
  double cells = 1e-9;
  for (std::size_t s = 0; s < std::min(a.submaps.size(), b.submaps.size()); ++s) {
    const Submap& of_a = a.submaps[s];
    const Submap& of_b = b.submaps[s];
    EXPECT_EQ(of_a.rect, of_b.rect);
    EXPECT_EQ(of_a.configurations.size(), of_b.configurations.size());
    if (of_a.rect != of_b.rect) continue;
    for (std::size_t k = 0; k < std::min(of_a.configurations.size(), of_b.configurations.size());
         ++k) {
      const ReflectionGrid& m = of_a.configurations[k].reflection;
      const ReflectionGrid& n = of_b.configurations[k].reflection;
      for (std::size_t i = 0; i < m.size(); ++i) {
        EXPECT_EQ(is_known(m.values()[i]), is_known(n.values()[i]));
        if (!is_known(m.values()[i]) || !is_known(n.values()[i])) continue;
        const double d = static_cast<double>(m.values()[i]) - static_cast<double>(n.values()[i]);
        squared += d * d;
        cells += 1.0;
      }
    }
  }
  return std::sqrt(squared / cells);
}

TEST(OnlinePatchLearner, EndsWithTheMapOfTheBatchLearner) {
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const auto scans = working_day(now_and_then(4 + 2 * seed, seed), 0.01, 0.1 * kDegree, seed);
    const ReflectionGrid base = test_world::map_of(scans);
    OnlinePatchLearner online({}, {}, base);
    for (const PosedScan& scan : scans) online.add(scan);
    const PatchMap whole = batch(scans, base);
    ASSERT_FALSE(whole.submaps.empty()) << "seed " << seed;
    // Counts are kept in single precision.
    EXPECT_LT(distance(online.finish(), whole), 1e-5) << "seed " << seed;
    EXPECT_EQ(online.status().pooled_sequences, 0U);
  }
}

TEST(OnlinePatchLearner, TheDoorAppearsOnceItsOtherStateWasSeenAndLeft) {
  const auto scans = working_day({true, true, false, false, true}, 0.01, 0.1 * kDegree, 3);
  OnlinePatchLearner online({}, {}, test_world::map_of(scans));
  std::vector<std::size_t> after_visit;  // configurations at the door
  std::size_t changes = 0;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    changes += online.add(scans[i]) ? 1 : 0;
    const bool is_last =
        i + 1 == scans.size() || (scans[i + 1].scan.stamp - scans[i].scan.stamp).seconds() > 10.0;
    if (!is_last) continue;
    const PatchMap map = online.map();
    after_visit.push_back(map.submaps.empty() ? 0 : map.submaps[0].configurations.size());
    if (!map.submaps.empty()) {
      EXPECT_TRUE(is_at_door(map.submaps[0]));
      EXPECT_EQ(map.submaps.size(), 1U);
    }
  }
  // The third visit sees it open; once the fourth has begun, that visit has ended.
  EXPECT_EQ(after_visit, (std::vector<std::size_t>{0, 0, 0, 2, 2}));
  EXPECT_LT(changes, 20U) << "most scans change nothing";
}

TEST(OnlinePatchLearner, WithoutChangeThereIsNeverASubmapAndTheBaseStays) {
  const auto scans = working_day(std::vector<bool>(6, true), 0.01, 0.1 * kDegree, 5);
  const ReflectionGrid base = test_world::map_of(scans);
  OnlinePatchLearner online({}, {}, base);
  for (const PosedScan& scan : scans) {
    online.add(scan);
    ASSERT_TRUE(online.map().submaps.empty());
  }
  const PatchMap map = online.finish();
  EXPECT_TRUE(map.submaps.empty());
  EXPECT_TRUE(same_bits(map.base, base));
}

TEST(OnlinePatchLearner, FillsInWhatTheBaseDoesNotKnowAndLeavesTheRest) {
  const auto closed = working_day({true, true}, 0.0, 0.0, 9);
  const ReflectionGrid base = test_world::map_of(closed);
  const Cell behind = cell_at({5.5, 3.5}, kResolution);
  ASSERT_FALSE(is_known(base.get(behind)));
  OnlineConfig strict;
  strict.extend_base = false;
  OnlinePatchLearner extending({}, {}, base);
  OnlinePatchLearner keeping({}, strict, base);
  for (const PosedScan& scan : working_day({true, false}, 0.0, 0.0, 9)) {
    extending.add(scan);
    keeping.add(scan);
  }
  const ReflectionGrid extended = extending.map().base;
  EXPECT_LT(extended.get(behind), 0.1F);
  for (std::size_t i = 0; i < base.size(); ++i) {
    if (!is_known(base.values()[i])) continue;
    ASSERT_EQ(extended.get(base.cell(i)), base.values()[i]);
  }
  EXPECT_TRUE(same_bits(keeping.map().base, base));
}

TEST(OnlinePatchLearner, KeepsItsBudgetOverALongRunAndStillKnowsTheDoor) {
  const auto closed = now_and_then(40, 6);
  const auto scans = working_day(closed, 0.01, 0.1 * kDegree, 6);
  OnlineConfig tight;
  tight.memory_mb = 4.0;
  OnlinePatchLearner online({}, tight, test_world::map_of(scans));
  std::size_t most = 0;
  for (const PosedScan& scan : scans) {
    online.add(scan);
    most = std::max(most, online.status().bytes);
    ASSERT_FALSE(online.status().is_over_budget);
  }
  EXPECT_LE(most, 4'000'000U);
  EXPECT_GT(most, 2'000'000U) << "uses what it may";
  EXPECT_LT(online.status().scans, scans.size() / 4) << "most scans are forgotten";
  EXPECT_GT(online.status().pooled_sequences, 0U);
  const PatchMap map = online.finish();
  ASSERT_EQ(map.submaps.size(), 1U);
  EXPECT_TRUE(is_at_door(map.submaps[0]));
  EXPECT_EQ(map.submaps[0].configurations.size(), 2U);
}

TEST(OnlinePatchLearner, ABudgetBelowTheAreaIsToldAndDoesNoHarm) {
  const auto scans = working_day({true, false, true}, 0.0, 0.0, 7);
  OnlineConfig tiny;
  tiny.memory_mb = 1.0;
  OnlinePatchLearner online({}, tiny, test_world::map_of(scans));
  bool was_over = false;
  for (const PosedScan& scan : scans) {
    online.add(scan);
    was_over = was_over || online.status().is_over_budget;
  }
  EXPECT_TRUE(was_over);
}

TEST(OnlinePatchLearner, ResultIsTheSameOnOneTwoAndEightThreads) {
  const auto scans = working_day(now_and_then(6, 8), 0.02, 0.3 * kDegree, 8);
  const ReflectionGrid base = test_world::map_of(scans);
  OnlinePatchLearner one({}, {}, base, 1);
  OnlinePatchLearner two({}, {}, base, 2);
  OnlinePatchLearner eight({}, {}, base, 8);
  for (const PosedScan& scan : scans) {
    const bool changed = one.add(scan);
    EXPECT_EQ(two.add(scan), changed);
    EXPECT_EQ(eight.add(scan), changed);
  }
  const PatchMap expected = one.finish();
  ASSERT_FALSE(expected.submaps.empty());
  for (OnlinePatchLearner* other : {&two, &eight}) {
    expect_same(other->finish(), expected);
  }
}

TEST(OnlinePatchLearner, GoesOnBitForBitFromItsSavedState) {
  const auto scans = working_day(now_and_then(10, 8), 0.02, 0.3 * kDegree, 8);
  const ReflectionGrid base = test_world::map_of(scans);
  for (const double memory_mb : {256.0, 4.0}) {  // with all that was seen, and after forgetting
    OnlineConfig config;
    config.memory_mb = memory_mb;
    OnlinePatchLearner whole({}, config, base);
    auto stopped = std::make_unique<OnlinePatchLearner>(PatchLearnerConfig{}, config, base);
    for (std::size_t i = 0; i < scans.size(); ++i) {
      if (i % (scans.size() / 7) == 100) {  // within sequences as well as between them
        const auto bytes = stopped->save_state();
        stopped = std::make_unique<OnlinePatchLearner>(PatchLearnerConfig{}, config,
                                                       make_reflection_grid(kResolution, {}));
        stopped->restore_state(bytes, "state");
        const PatchMap map = stopped->map();
        const PatchMap expected = whole.map();
        ASSERT_EQ(map.submaps.size(), expected.submaps.size());
        for (std::size_t s = 0; s < map.submaps.size(); ++s) {
          EXPECT_EQ(map.submaps[s].recurrence, expected.submaps[s].recurrence);
        }
      }
      ASSERT_EQ(stopped->add(scans[i]), whole.add(scans[i])) << "scan " << i;
    }
    EXPECT_EQ(stopped->status().bytes, whole.status().bytes);
    EXPECT_EQ(stopped->status().pooled_sequences, whole.status().pooled_sequences);
    EXPECT_EQ(whole.status().scans < scans.size(), memory_mb < 10.0);
    const PatchMap expected = whole.finish();
    const PatchMap map = stopped->finish();
    ASSERT_FALSE(expected.submaps.empty());
    expect_same(map, expected);
    EXPECT_TRUE(same_bits(map.base, expected.base));
    for (std::size_t s = 0; s < map.submaps.size(); ++s) {
      EXPECT_EQ(map.submaps[s].sequences.size(), expected.submaps[s].sequences.size());
    }
  }
}

TEST(OnlinePatchLearner, RefusesAStateThatIsCutOrDamagedOrOfAnotherResolution) {
  const auto scans = working_day(now_and_then(5, 4), 0.01, 0.1 * kDegree, 4);
  const ReflectionGrid base = test_world::map_of(scans);
  OnlinePatchLearner learner({}, {}, base);
  for (const PosedScan& scan : scans) learner.add(scan);
  const std::vector<std::uint8_t> bytes = learner.save_state();
  const auto restores = [&](std::span<const std::uint8_t> state, double resolution_m) {
    OnlinePatchLearner other({}, {}, make_reflection_grid(resolution_m, {}));
    try {
      other.restore_state(state, "state");
    } catch (const InputError&) {
      return false;
    }
    (void)other.finish();  // whatever passes must not lead out of memory
    return true;
  };
  EXPECT_TRUE(restores(bytes, kResolution));
  EXPECT_FALSE(restores(bytes, 0.1));
  RandomStream random(1, StreamId::kTest, 0);
  for (int i = 0; i < 50; ++i) {
    const auto length =
        static_cast<std::size_t>(random.uniform(0.0, static_cast<double>(bytes.size())));
    EXPECT_FALSE(restores(std::span(bytes).first(length), kResolution)) << length;
  }
  std::vector<std::uint8_t> longer = bytes;
  longer.push_back(0);
  EXPECT_FALSE(restores(longer, kResolution));
}

TEST(OnlinePatchLearner, UnusableScansAndBadSettingsAreHarmlessOrRefused) {
  OnlinePatchLearner online({}, {}, make_reflection_grid(kResolution, {}));
  PosedScan scan;
  scan.map_from_robot.x = std::nan("");
  EXPECT_FALSE(online.add(scan)) << "a pose that is not finite";
  scan.map_from_robot = {};
  EXPECT_FALSE(online.add(scan)) << "no beams";
  scan.scan.range_max_m = 10.0F;
  scan.scan.ranges_m.assign(180, std::nanf(""));
  EXPECT_FALSE(online.add(scan)) << "no valid beams";
  EXPECT_TRUE(online.finish().submaps.empty());
  OnlineConfig bad;
  bad.max_visits = 1;
  EXPECT_THROW(OnlinePatchLearner({}, bad, make_reflection_grid(kResolution, {})), ConfigError);
}

}  // namespace
}  // namespace strata::patch
