// SPDX-License-Identifier: Apache-2.0
/// A door of office hours, seen by a laser for two weeks: learned online, over a restart, and at
/// once from all scans.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "core/patch/online_learner.hpp"
#include "core/patch/patch_learner.hpp"
#include "core/random/stream.hpp"
#include "tests/core/patch/toy_map.hpp"
#include "tests/core/patch/toy_world.hpp"

namespace strata::patch {
namespace {

constexpr double kOneHour_s = 3600.0;
constexpr int kDays = 16;

/// Passes at 7, 10, 13, 16 and 19 h, give or take; open from 9 to 17 but for one in ten.
std::vector<std::vector<PosedScan>> two_weeks() {
  RandomStream random(8, StreamId::kTest);
  test_world::ToyRobot robot;
  robot.beams = 90;
  std::vector<std::vector<PosedScan>> passes;
  for (int day = 0; day < kDays; ++day) {
    for (const double hour : {7.0, 10.0, 13.0, 16.0, 19.0}) {
      const bool is_day = hour > 9.0 && hour < 17.0;
      const bool is_open = random.bernoulli(is_day ? 0.9 : 0.1);
      const double y = random.uniform(1.1, 1.4);
      passes.emplace_back();
      robot.drive(test_world::corridor_with_door(!is_open), {5.3, y, 0.0}, {5.75, y, 0.0}, 0,
                  24.0 * kOneHour_s * day + kOneHour_s * (hour + random.uniform(0.0, 0.5)), {},
                  random, passes.back());
    }
  }
  return passes;
}

/// The share at that hour of any day of the configuration in which the door's cells are free.
double open_at(const Submap& door, double hour) {
  std::size_t open = 0;
  double least = 1e9;
  for (std::size_t k = 0; k < door.configurations.size(); ++k) {
    double sum = 0.0;
    for (std::size_t i = 0; i < door.contradictory.size(); ++i) {
      if (door.contradictory.values()[i] == 0) continue;
      sum += static_cast<double>(door.configurations[k].reflection.values()[i]);
    }
    if (sum < least) open = k;
    least = std::min(least, sum);
  }
  std::vector<double> shares(door.configurations.size());
  periodic::shares_at(door.usual, hour / 168.0, shares);
  return shares[open];
}

void expect_office_hours(const PatchMap& map) {
  ASSERT_EQ(map.submaps.size(), 1U);
  const Submap& door = map.submaps[0];
  ASSERT_EQ(door.configurations.size(), 2U);
  ASSERT_TRUE(door.usual.is_periodic());
  EXPECT_GT(open_at(door, 13.25), 0.75);
  EXPECT_LT(open_at(door, 7.25), 0.4);
  EXPECT_LT(open_at(door, 19.25), 0.4);
}

TEST(OnlineTimes, ADoorOfOfficeHoursIsKnownAsSuch) {
  const auto passes = two_weeks();
  OnlineConfig config;
  config.check_every_s = 12.0 * kOneHour_s;
  config.max_sequences = 12;
  const ReflectionGrid base = test_world::map_of(passes.front());
  OnlinePatchLearner learner({}, config, base);
  auto restarted = std::make_unique<OnlinePatchLearner>(PatchLearnerConfig{}, config, base);
  for (std::size_t i = 0; i < passes.size(); ++i) {
    for (const PosedScan& scan : passes[i]) {
      (void)learner.add(scan);
      (void)restarted->add(scan);
    }
    if (i == 3 * passes.size() / 4) {  // fewer days are left than are asked
      const std::vector<std::uint8_t> bytes = restarted->save_state();
      restarted = std::make_unique<OnlinePatchLearner>(PatchLearnerConfig{}, config, base);
      restarted->restore_state(bytes, "the state");
    }
  }
  const PatchMap map = learner.finish();
  EXPECT_GT(learner.status().pooled_sequences, 20U);
  expect_office_hours(map);
  EXPECT_EQ(restarted->finish().submaps.at(0).usual, map.submaps.at(0).usual) << "over a restart";
}

TEST(OnlineTimes, AtOnceFromAllScansTheyAreTheSame) {
  const auto passes = two_weeks();
  PatchLearner learner({});
  for (const auto& pass : passes) {
    for (const PosedScan& scan : pass) learner.add(scan);
  }
  expect_office_hours(learner.finish(test_world::map_of(passes.front())));
}

}  // namespace
}  // namespace strata::patch
