// SPDX-License-Identifier: Apache-2.0
/// A learner that gets no memory in the middle of its work loses what it was at, and nothing else:
/// what it holds fits together, and it goes on. A program of its own, since it replaces the global
/// allocation functions.
#include <cstddef>
#include <cstdint>
#include <new>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/patch/online_learner.hpp"
#include "core/random/stream.hpp"
#include "tests/core/patch/toy_map.hpp"
#include "tests/core/patch/toy_world.hpp"
#include "tests/support/counted_allocations.hpp"

namespace strata::patch {
namespace {

/// Restoring looks at all that a learner holds.
void expect_sound(const OnlinePatchLearner& learner, const OnlineConfig& online,
                  const ReflectionGrid& base) {
  OnlinePatchLearner other({}, online, base, 1);
  ASSERT_NO_THROW(other.restore_state(learner.save_state(), "the learner"));
}

/// A day of a door that is passed by again and again.
std::vector<PosedScan> drives(std::uint64_t seed) {
  RandomStream random(seed, StreamId::kTest, 8);
  std::vector<bool> closed;
  for (int visit = 0; visit < 24; ++visit) {
    closed.push_back(visit < 4 ? visit % 2 == 0 : random.bernoulli(0.5));
  }
  return test_world::drive_past_door(closed, 0.01, 0.0, seed, test_world::Visits::kOneRun);
}

/// memory_mb: little makes it forget scans, sequences and configurations all the time.
std::size_t learn_with_failures(const std::vector<PosedScan>& scans, double memory_mb,
                                std::uint64_t seed) {
  RandomStream random(seed, StreamId::kTest, 7);
  const ReflectionGrid base = test_world::map_of(scans);
  OnlineConfig online;
  online.memory_mb = memory_mb;
  online.max_sequences = 10;
  OnlinePatchLearner learner({}, online, base, 1);
  std::size_t failures = 0;
  for (const PosedScan& scan : scans) {
    if (random.bernoulli(0.15)) {
      const double most = random.bernoulli(0.2) ? 2000.0 : 30.0;
      strata::test::failing_allocation =
          strata::test::allocations + 1 + static_cast<std::size_t>(random.uniform(0.0, most));
    }
    bool has_failed = false;
    try {
      (void)learner.add(scan);
    } catch (const std::bad_alloc&) {
      has_failed = true;
    }
    strata::test::failing_allocation = 0;
    if (!has_failed) continue;
    ++failures;
    expect_sound(learner, online, base);
    if (testing::Test::HasFatalFailure()) return failures;
  }
  EXPECT_FALSE(learner.finish().submaps.empty()) << "the door is found all the same";
  return failures;
}

TEST(MemoryRunsOut, AndALearnerStaysSoundAndGoesOn) {
  EXPECT_GT(learn_with_failures(drives(1), 256.0, 1), 40U);
}

TEST(MemoryRunsOut, AndALearnerThatCutsSequencesAgainStaysSoundAndGoesOn) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE(seed);
    const auto scans =
        test_world::stand_before_door({70.0, 50.0, 110.0, 45.0, 60.0, 33.0, 40.0, 90.0}, seed);
    EXPECT_GT(learn_with_failures(scans, 256.0, seed), 20U);
  }
}

TEST(MemoryRunsOut, AndALearnerThatForgetsStaysSoundAndGoesOn) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    SCOPED_TRACE(seed);
    EXPECT_GT(learn_with_failures(drives(seed), 1.0, seed), 40U);
  }
}

}  // namespace
}  // namespace strata::patch
