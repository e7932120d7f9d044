// SPDX-License-Identifier: Apache-2.0
/// An online learner whose scans turn out to have been taken elsewhere, as after a loop closure.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "core/patch/online_learner.hpp"
#include "core/random/stream.hpp"
#include "tests/core/patch/toy_map.hpp"
#include "tests/core/patch/toy_world.hpp"

namespace strata::patch {
namespace {

/// Drives to and fro past a door that is closed and open in turn.
std::vector<PosedScan> drives(std::size_t visits) {
  std::vector<PosedScan> scans;
  for (std::size_t v = 0; v < visits; ++v) {
    RandomStream random(21, StreamId::kTest, v);
    const double y = random.uniform(0.9, 1.5);
    test_world::ToyRobot{}.drive(test_world::corridor_with_door(v % 2 == 0), {1.0, y, 0.0},
                                 {10.0, y, 0.0}, 0, 100.0 * static_cast<double>(v), {}, random,
                                 scans);
  }
  return scans;
}

/// As before a loop was closed: off by more and more from drive to drive.
std::vector<PosedScan> drifted(std::vector<PosedScan> scans) {
  for (PosedScan& scan : scans) {
    const double drives = std::floor(scan.scan.stamp.seconds() / 100.0);
    scan.map_from_robot = Pose2{0.07 * drives, 0.11 * drives, 0.0} * scan.map_from_robot;
  }
  return scans;
}

/// The right pose of each scan, by its stamp; of those of every `nth` only.
OnlinePatchLearner::PoseOf right_poses(const std::vector<PosedScan>& right, std::size_t nth = 1) {
  std::map<std::int64_t, Pose2> poses;
  for (std::size_t i = 0; i < right.size(); i += nth) {
    poses[right[i].scan.stamp.ns] = right[i].map_from_robot;
  }
  return [poses](const PosedScan& scan) {
    const auto found = poses.find(scan.scan.stamp.ns);
    return found == poses.end() ? std::nullopt : std::optional(found->second);
  };
}

/// A learner that was given the scans.
std::unique_ptr<OnlinePatchLearner> learner_of(const std::vector<PosedScan>& scans,
                                               const ReflectionGrid& base,
                                               double memory_mb = 256.0) {
  OnlineConfig config;
  config.memory_mb = memory_mb;
  auto learner = std::make_unique<OnlinePatchLearner>(PatchLearnerConfig{}, config, base);
  for (const PosedScan& scan : scans) (void)learner->add(scan);
  return learner;
}

TEST(OnlineMoves, MovedScansGiveTheLearnerThatWasGivenTheirPosesAtOnce) {
  const auto right = drives(6);
  const ReflectionGrid base = test_world::map_of(right);
  const auto moved = learner_of(drifted(right), base);
  const auto expected = learner_of(right, base);
  ASSERT_EQ(expected->map().submaps.size(), 1U);
  ASSERT_FALSE(moved->map().submaps.empty());
  EXPECT_FALSE(moved->map().submaps[0].rect == expected->map().submaps[0].rect);
  EXPECT_TRUE(moved->move_scans(right_poses(right)));
  EXPECT_EQ(moved->save_state(), expected->save_state());
}

TEST(OnlineMoves, AScanOfUnknownPlaceGoesAlongWithTheOneBeforeIt) {
  const auto right = drives(6);
  const ReflectionGrid base = test_world::map_of(right);
  const auto moved = learner_of(drifted(right), base);
  EXPECT_TRUE(moved->move_scans(right_poses(right, 7)));
  const PatchMap map = moved->finish();
  const PatchMap wanted = learner_of(right, base)->finish();
  ASSERT_EQ(map.submaps.size(), 1U);
  EXPECT_EQ(map.submaps[0].configurations.size(), wanted.submaps[0].configurations.size());
}

TEST(OnlineMoves, NothingIsDoneWhereNothingMovedByHalfACell) {
  const auto right = drives(4);
  const auto learner = learner_of(right, test_world::map_of(right));
  const auto before = learner->save_state();
  EXPECT_FALSE(learner->move_scans(right_poses(right)));
  EXPECT_FALSE(learner->move_scans([](const PosedScan&) { return std::nullopt; }));
  EXPECT_FALSE(learner->move_scans([](const PosedScan& scan) {
    return std::optional(Pose2{0.02, 0.0, 0.0} * scan.map_from_robot);
  }));
  EXPECT_FALSE(learner->move_scans([](const PosedScan&) {
    return std::optional(Pose2{std::nan(""), 0.0, 0.0});
  }));
  EXPECT_EQ(learner->save_state(), before);
}

TEST(OnlineMoves, OneThatLearnedAgainMeanwhileCatchesUpWithTheOneThatWentOn) {
  const auto right = drives(6);
  const ReflectionGrid base = test_world::map_of(right);
  const auto half = static_cast<std::ptrdiff_t>(right.size() / 2);
  const auto fresh = learner_of({right.begin(), right.begin() + half}, base);
  const auto gone_on = learner_of(drifted(right), base);
  EXPECT_TRUE(fresh->catch_up_with(*gone_on, right_poses(right)));
  EXPECT_EQ(fresh->save_state(), learner_of(right, base)->save_state());
  EXPECT_TRUE(fresh->catch_up_with(*gone_on, right_poses(right)));
  EXPECT_EQ(fresh->status().scans_seen, right.size()) << "none twice";
}

TEST(OnlineMoves, NothingCatchesUpWithScansThatAreForgotten) {
  const auto right = drives(12);
  const ReflectionGrid base = test_world::map_of(right);
  const auto gone_on = learner_of(right, base, 2.0);
  ASSERT_TRUE(gone_on->has_forgotten());
  const auto fresh = learner_of({right.begin(), right.begin() + 3}, base);
  EXPECT_FALSE(fresh->catch_up_with(*gone_on, right_poses(right)));
  EXPECT_EQ(fresh->status().scans_seen, 3U);
}

TEST(OnlineMoves, WhatForgottenScansSaidStays) {
  const auto right = drives(12);
  const auto learner = learner_of(right, test_world::map_of(right), 2.0);
  ASSERT_LT(learner->status().scans, right.size());
  const std::size_t seen = learner->status().scans_seen;
  const std::size_t sequences = learner->status().sequences;
  ASSERT_EQ(learner->map().submaps.size(), 1U);
  const auto shifted = [](const PosedScan& scan) {
    return std::optional(Pose2{0.06, 0.0, 0.0} * scan.map_from_robot);
  };
  EXPECT_TRUE(learner->move_scans(shifted));
  EXPECT_EQ(learner->status().scans_seen, seen);
  EXPECT_EQ(learner->status().sequences, sequences);
  EXPECT_EQ(learner->map().submaps.size(), 1U);
}

}  // namespace
}  // namespace strata::patch
