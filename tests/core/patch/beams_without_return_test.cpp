// SPDX-License-Identifier: Apache-2.0
// A gate onto nothing: only beams without return show that it is open.
#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "core/patch/online_learner.hpp"
#include "core/patch/patch_learner.hpp"
#include "tests/core/patch/gate_world.hpp"
#include "tests/core/patch/toy_map.hpp"
#include "tests/support/same_bits.hpp"

namespace strata::patch {
namespace {

using test_world::drive_past_gate;
using test_world::gates_of;
using test_world::kGateOfEightDays;

PatchMap learn_gates(const std::vector<PosedScan>& scans, const PatchLearnerConfig& config) {
  PatchLearner learner(config, 1);
  for (const PosedScan& scan : scans) learner.add(scan);
  return learner.finish(test_world::map_of(scans));
}

TEST(BeamsWithoutReturn, ShowThatAGateOntoNothingIsOpen) {
  const std::vector<PosedScan> scans = drive_past_gate(kGateOfEightDays);
  EXPECT_EQ(gates_of(learn_gates(scans, {})), 1);
  EXPECT_EQ(learn_gates(scans, {}).submaps.size(), 1U);
  PatchLearnerConfig without;
  without.no_return.is_used = false;
  EXPECT_EQ(learn_gates(scans, without).submaps.size(), 0U) << "nothing else shows it";
}

TEST(BeamsWithoutReturn, ShowItWhileScansCome) {
  const std::vector<PosedScan> scans = drive_past_gate(kGateOfEightDays);
  OnlinePatchLearner learner({}, {}, test_world::map_of(scans));
  for (const PosedScan& scan : scans) (void)learner.add(scan);
  EXPECT_EQ(gates_of(learner.finish()), 1);
  EXPECT_GT(learner.drop_outs().free_range_m, 5.0);
}

TEST(BeamsWithoutReturn, OfAnOnlineLearnerAreTheSameAfterARestart) {
  const std::vector<PosedScan> scans = drive_past_gate(kGateOfEightDays);
  const ReflectionGrid base = test_world::map_of(scans);
  OnlinePatchLearner whole({}, {}, base);
  auto stopped = std::make_unique<OnlinePatchLearner>(PatchLearnerConfig{}, OnlineConfig{}, base);
  for (std::size_t i = 0; i < scans.size(); ++i) {
    if (i % 101 == 50) {
      const auto bytes = stopped->save_state();
      stopped = std::make_unique<OnlinePatchLearner>(PatchLearnerConfig{}, OnlineConfig{}, base);
      stopped->restore_state(bytes, "state");
    }
    ASSERT_EQ(stopped->add(scans[i]), whole.add(scans[i])) << i;
  }
  EXPECT_EQ(stopped->drop_outs(), whole.drop_outs());
  const PatchMap map = stopped->finish();
  const PatchMap expected = whole.finish();
  ASSERT_EQ(map.submaps.size(), expected.submaps.size());
  for (std::size_t s = 0; s < map.submaps.size(); ++s) {
    const auto& configurations = map.submaps[s].configurations;
    ASSERT_EQ(configurations.size(), expected.submaps[s].configurations.size());
    for (std::size_t k = 0; k < configurations.size(); ++k) {
      EXPECT_TRUE(strata::test::same_bits(configurations[k].reflection,
                                          expected.submaps[s].configurations[k].reflection));
    }
  }
}

TEST(BeamsWithoutReturn, AStateFromBeforeIsGoneOnFrom) {
  const std::vector<PosedScan> scans = drive_past_gate(kGateOfEightDays);
  const ReflectionGrid base = test_world::map_of(scans);
  PatchLearnerConfig without;
  without.no_return.is_used = false;
  OnlinePatchLearner before(without, {}, base);
  for (std::size_t i = 0; i < 200; ++i) (void)before.add(scans[i]);
  std::vector<std::uint8_t> bytes = before.save_state();
  // The watch without scanners, and of each scan how far it saw and a list without beams.
  bytes.resize(bytes.size() - 8 - 200 * (4 + 8));
  bytes[0] = 7;
  OnlinePatchLearner after({}, {}, base);
  after.restore_state(bytes, "state");
  for (std::size_t i = 200; i < scans.size(); ++i) (void)after.add(scans[i]);
  EXPECT_EQ(gates_of(after.finish()), 1);
}

}  // namespace
}  // namespace strata::patch
