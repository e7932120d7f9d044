// SPDX-License-Identifier: Apache-2.0
#include "components/patch_learner/relearner.hpp"

#include <memory>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "tests/core/patch/toy_map.hpp"
#include "tests/core/patch/toy_world.hpp"
#include "tests/support/comes_true.hpp"

namespace strata::patch_learner {
namespace {

std::vector<PosedScan> drives() {
  return patch::test_world::drive_past_door({true, false}, 0.0, 0.0, 21,
                                            patch::test_world::Visits::kOneRun);
}

std::unique_ptr<patch::OnlinePatchLearner> made_by(Relearner& relearner) {
  EXPECT_TRUE(test::comes_true([&] { return !relearner.is_busy(); }));
  return relearner.take();
}

TEST(Relearner, MakesTheLearnerThatWasGivenThoseScansOnce) {
  const auto scans = drives();
  const ReflectionGrid base = patch::test_world::map_of(scans);
  Relearner relearner({}, {}, 1);
  EXPECT_FALSE(relearner.is_busy());
  EXPECT_EQ(relearner.take(), nullptr);
  relearner.begin(scans, base);
  const auto made = made_by(relearner);
  ASSERT_NE(made, nullptr);
  patch::OnlinePatchLearner wanted({}, {}, base);
  for (const PosedScan& scan : scans) (void)wanted.add(scan);
  EXPECT_EQ(made->save_state(), wanted.save_state());
  EXPECT_EQ(relearner.take(), nullptr);
  relearner.begin({scans.front()}, base);
  const auto next = made_by(relearner);
  ASSERT_NE(next, nullptr);
  EXPECT_EQ(next->status().scans_seen, 1U);
}

TEST(Relearner, GivesUpWhenItGoes) {
  const auto scans = drives();
  std::vector<PosedScan> many;  // minutes of work
  for (int i = 0; i < 500; ++i) many.insert(many.end(), scans.begin(), scans.begin() + 20);
  Relearner relearner({}, {}, 1);
  relearner.begin(std::move(many), patch::test_world::map_of(scans));
  EXPECT_TRUE(relearner.is_busy());
  EXPECT_EQ(relearner.take(), nullptr) << "it has just begun";
}

TEST(Relearner, TellsWhatEndedItsWork) {
  patch::PatchLearnerConfig broken;
  broken.prior = 0.1;
  Relearner relearner(broken, {}, 1);
  relearner.begin(drives(), make_reflection_grid(0.05, {{0, 0}, {1, 1}}));
  EXPECT_TRUE(test::comes_true([&] { return !relearner.is_busy(); }));
  EXPECT_THROW((void)relearner.take(), ConfigError);
  EXPECT_EQ(relearner.take(), nullptr) << "once";
}

}  // namespace
}  // namespace strata::patch_learner
