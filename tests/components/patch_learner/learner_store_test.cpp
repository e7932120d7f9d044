// SPDX-License-Identifier: Apache-2.0
#include "components/patch_learner/learner_store.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "core/base/error.hpp"
#include "core/grid/counting_map.hpp"
#include "tests/core/patch/toy_world.hpp"
#include "tests/support/same_bits.hpp"
#include "tests/support/test_data.hpp"
#include "tests/support/watched_disk.hpp"

namespace fs = std::filesystem;

namespace strata::patch_learner {
namespace {

/// Visits of a corridor whose door is now open, now closed; two runs.
std::vector<PosedScan> visits() {
  std::vector<PosedScan> scans;
  for (int v = 0; v < 8; ++v) {
    RandomStream random(3, StreamId::kTest, static_cast<std::uint64_t>(v));
    patch::test_world::ToyRobot{}.drive(patch::test_world::corridor_with_door(v % 2 == 0),
                                        {1.0, 1.2, 0.0}, {10.0, 1.2, 0.0}, v / 4, 100.0 * v, {},
                                        random, scans);
  }
  return scans;
}

class LearnerStoreTest : public ::testing::Test {
 protected:
  LearnerStoreTest() {
    CountingMap counts(0.05);
    for (const PosedScan& scan : scans_) counts.add(scan);
    base_ = counts.reflection();
  }
  [[nodiscard]] patch::OnlinePatchLearner fresh() const {
    return patch::OnlinePatchLearner({}, {}, base_);
  }
  [[nodiscard]] fs::path folder() const { return folder_.path() / "learned"; }
  /// A process that learns these scans and is killed after the last flush.
  void live(std::size_t begin, std::size_t end, double state_period_s) {
    patch::OnlinePatchLearner learner = fresh();
    LearnerStore store(folder(), state_period_s);
    if (store.has_state()) {
      EXPECT_EQ(store.restore(learner), scans_[begin - 1].run);
    }
    EXPECT_EQ(learner.status().scans_seen, begin) << "nothing is lost, nothing comes twice";
    store.begin(learner);
    for (std::size_t i = begin; i < end; ++i) {
      learner.add(scans_[i]);
      store.add(learner, scans_[i]);
      if (i % 5 == 0 || i + 1 == end) store.flush();
    }
  }

  const std::vector<PosedScan> scans_ = visits();
  ReflectionGrid base_;

 private:
  test::TemporaryDirectory folder_;
};

TEST_F(LearnerStoreTest, ALearnerThatIsStoppedAgainAndAgainKnowsWhatOneThatNeverStoppedKnows) {
  for (const double state_period_s : {1e6, 30.0}) {  // from scans alone, and from states
    const std::size_t part = scans_.size() / 5;
    for (std::size_t p = 0; p < 5; ++p) {
      live(p * part, p == 4 ? scans_.size() : (p + 1) * part, state_period_s);
    }
    patch::OnlinePatchLearner stopped = fresh();
    EXPECT_EQ(LearnerStore(folder(), state_period_s).restore(stopped), scans_.back().run);
    patch::OnlinePatchLearner whole = fresh();
    for (const PosedScan& scan : scans_) whole.add(scan);
    EXPECT_EQ(stopped.status().scans_seen, whole.status().scans_seen);
    EXPECT_EQ(stopped.status().bytes, whole.status().bytes);
    const patch::PatchMap expected = whole.finish();
    const patch::PatchMap map = stopped.finish();
    ASSERT_EQ(expected.submaps.size(), 1U);
    ASSERT_EQ(map.submaps.size(), 1U);
    const patch::Submap& submap = map.submaps[0];
    EXPECT_EQ(submap.sequences.size(), expected.submaps[0].sequences.size());
    ASSERT_EQ(submap.configurations.size(), expected.submaps[0].configurations.size());
    for (std::size_t k = 0; k < submap.configurations.size(); ++k) {
      EXPECT_TRUE(strata::test::same_bits(submap.configurations[k].reflection,
                                          expected.submaps[0].configurations[k].reflection));
    }
    fs::remove_all(folder());
  }
}

TEST_F(LearnerStoreTest, ACrashBetweenTheStateAndItsScansLeavesAPairThatFits) {
  live(0, 40, 1e6);
  const fs::path kept = folder().string() + ".kept";
  fs::copy(folder(), kept);  // the scans before the next state
  live(40, 60, 1e6);
  for (const auto& entry : fs::directory_iterator(kept)) {
    if (entry.path().extension() == ".state") continue;
    fs::copy(entry.path(), folder() / entry.path().filename());
  }
  live(60, 80, 1e6);
}

TEST_F(LearnerStoreTest, RefusesDamagedFilesAndLeavesThemAsTheyAre) {
  live(0, 40, 1e6);
  const fs::path state = folder() / "learner.state";
  const auto size = fs::file_size(state);
  fs::resize_file(state, size / 2);
  patch::OnlinePatchLearner learner = fresh();
  EXPECT_THROW((void)LearnerStore(folder(), 1e6).restore(learner), InputError);
  std::ofstream(state, std::ios::trunc) << "no state";
  EXPECT_THROW((void)LearnerStore(folder(), 1e6).restore(learner), InputError);
  EXPECT_EQ(fs::file_size(state), 8U);
  EXPECT_FALSE(fs::is_empty(folder()));
}

TEST_F(LearnerStoreTest, FindsEveryFlippedBitOfAState) {
  live(0, 40, 1e6);
  const fs::path file = folder() / "learner.state";
  const std::string bytes = test::bytes_of(file);
  RandomStream random(5, StreamId::kTest, 0);
  for (int i = 0; i < 40; ++i) {
    std::string damaged = bytes;
    const auto place =
        static_cast<std::size_t>(random.uniform(0.0, static_cast<double>(bytes.size())));
    damaged[place] = static_cast<char>(damaged[place] ^ (1 << (i % 8)));
    std::ofstream(file, std::ios::binary | std::ios::trunc) << damaged;
    patch::OnlinePatchLearner learner = fresh();
    EXPECT_THROW((void)LearnerStore(folder(), 1e6).restore(learner), InputError) << place;
  }
}

TEST_F(LearnerStoreTest, AStateThatCannotBeWrittenLeavesTheOneBeforeAndItsScans) {
  live(0, 40, 1e6);
  patch::OnlinePatchLearner learner = fresh();
  LearnerStore store(folder(), 5.0);
  store.restore(learner);
  store.begin(learner);
  std::size_t next = 40;
  const auto take = [&] {
    learner.add(scans_[next]);
    store.add(learner, scans_[next++]);
  };
  take();
  store.flush();
  const fs::path aside = folder() / ".learner.state.partial";
  fs::create_directory(aside.string() + "-" + std::to_string(getpid()));
  std::size_t failures = 0;
  while (next < 120) {
    try {
      take();
    } catch (const OutputError&) {
      ++failures;
    }
  }
  store.flush();
  EXPECT_GT(failures, 0U);
  EXPECT_LT(failures, 20U) << "tried again once a period only";
  patch::OnlinePatchLearner after = fresh();
  EXPECT_EQ(LearnerStore(folder(), 5.0).restore(after), scans_[40].run);
  EXPECT_EQ(after.status().scans_seen, 41U) << "what was written before";
  // There is room again when the process ends, before the next state is due.
  fs::remove(aside.string() + "-" + std::to_string(getpid()));
  store.finish(learner);
  patch::OnlinePatchLearner at_last = fresh();
  EXPECT_EQ(LearnerStore(folder(), 5.0).restore(at_last), scans_[119].run);
  EXPECT_EQ(at_last.status().scans_seen, 120U);
}

TEST_F(LearnerStoreTest, KeepsTheScansUntilTheStateThatHoldsThemIsOnTheDisk) {
  live(0, 40, 1e6);
  const strata::test::WatchedDisk disk;
  patch::OnlinePatchLearner learner = fresh();
  LearnerStore store(folder(), 1e6, disk);
  store.restore(learner);
  store.begin(learner);
  EXPECT_THAT(disk.steps(), ::testing::ElementsAre("sync .learner.state.partial",
                                                   "rename .learner.state.partial to learner.state",
                                                   "sync learned", "remove scans_0.db"));
}

TEST_F(LearnerStoreTest, AFolderThatCannotBeMadeIsToldAtOnce) {
  std::ofstream(folder().string()) << "a file";
  EXPECT_THROW(LearnerStore(folder() / "below", 1e6), OutputError);
}

}  // namespace
}  // namespace strata::patch_learner
