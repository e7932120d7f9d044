// SPDX-License-Identifier: Apache-2.0
/// The patches that a mapper saves among people who bend its trajectory while it drives: mapper and
/// patch learner of lifelong.yaml without what lies between them, so that the bits are the same on
/// any machine.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "components/convert/patch_messages.hpp"
#include "components/maps/earlier_runs.hpp"
#include "components/maps/maps_folder.hpp"
#include "components/scan_matcher/maps_saver.hpp"
#include "core/patch/online_learner.hpp"
#include "core/slam/live_map.hpp"
#include "core/slam/resumed_place.hpp"
#include "tests/across/lifelong/map_quality.hpp"
#include "tests/support/test_data.hpp"
#include "tools/pipeline/learn.hpp"
#include "tools/simulate/random_office.hpp"

namespace strata::test {
namespace {

constexpr std::uint64_t kFilterSeeds[] = {1, 2, 3};
constexpr slam::KeepConfig kKeep{.window_scans = 2'000};

/// STRATA_LIFELONG_SEED: of another office, for figures.
std::uint64_t seed() {
  const char* const text = std::getenv("STRATA_LIFELONG_SEED");
  return text != nullptr ? static_cast<std::uint64_t>(std::atoll(text)) : 34;
}

/// Days in an office, of which the last one is not mapped.
struct Days {
  explicit Days(int count)
      : simulation(simulate::simulate(simulate::random_office(seed(), {.days = count}), seed())) {
    for (std::size_t day = 0; day + 1 < simulation.days.size(); ++day) {
      for (const simulate::SimulatedScan& scan : simulation.days[day].scans) {
        observations.push_back(scan.observation);
        observations.back().run = 0;  // odometry goes on over the night
        truth[scan.observation.scan.stamp.ns] = scan.map_from_robot;
      }
      ends.push_back(observations.size());
    }
  }
  [[nodiscard]] MapQuality quality_of(const maps::Maps& maps,
                                      const std::vector<PosedScan>& mapped) const {
    return judge(maps, mapped, truth, simulation.days.back(), kFilterSeeds);
  }

  simulate::Simulation simulation;
  std::vector<Observation> observations;
  std::vector<std::size_t> ends;
  Truth truth;
};

/// A mapper and a patch learner at work.
class Mapper {
 public:
  explicit Mapper(const slam::KeepConfig& keep) : keep_(keep) { make_slam(); }

  void see(Observation observation) {
    observation.run = run_;
    const Pose2Gaussian pose = slam_->add(observation);
    learner_.add(PosedScan{run_, observation.scan, pose.mean, {}});
  }
  [[nodiscard]] std::vector<std::uint8_t> state() const { return slam_->save_state(); }
  /// A mapper was killed and begins again, as strata::ScanMatcher does: it has lost what came since
  /// that state. The learner has not.
  void begin_again(const std::vector<std::uint8_t>& state, const Observation& first) {
    make_slam();
    slam_->restore_state(state, "a test");
    const bool is_recent = (first.scan.stamp - slam_->newest()->stamp).seconds() <= 10.0;
    run_ = slam::resume_run(*slam_, first, is_recent, {}, pose_covariance(0.3, 0.2)).run;
  }
  [[nodiscard]] scan_matcher::Snapshot snapshot() {
    std::map<std::int64_t, Pose2> poses;  // as a trajectory tells them
    slam_->visit_kept([&](const slam::Slam::Mapped& mapped) {
      poses[mapped.scan->scan.stamp.ns] = mapped.map_from_robot;
    });
    (void)learner_.move_scans([&](const PosedScan& scan) {
      const auto found = poses.find(scan.scan.stamp.ns);
      return found == poses.end() ? std::nullopt : std::optional(found->second);
    });
    slam::LiveMap map(beam_filter::BeamFilterConfig{});
    (void)map.update(*slam_, poses.size());
    learner_.set_base(map.filtered());
    return {slam_->save_state(), convert::to_message(learner_.finish(), Stamp(), "map")};
  }

 private:
  void make_slam() { slam_ = std::make_unique<slam::Slam>(slam::SlamConfig{}, 1, keep_); }

  slam::KeepConfig keep_;
  int run_ = 0;
  std::unique_ptr<slam::Slam> slam_;
  patch::OnlinePatchLearner learner_{{}, {}, make_reflection_grid(0.05, {{0, 0}, {1, 1}})};
};

/// A folder that was saved, and how many of its sub-maps are as the live learner had them.
struct Saved {
  Saved(const scan_matcher::Snapshot& snapshot, const slam::KeepConfig& keep) {
    const TemporaryDirectory folder;
    scan_matcher::MapsSaver saver(folder.path() / "maps", {{}, keep, {}});
    saver.save(snapshot, {});
    saver.flush();
    live_submaps = saver.live_submaps();
    maps = maps::read_maps(folder.path() / "maps");
    scans = maps::read_earlier_runs(folder.path() / "maps").scans;
  }

  std::size_t live_submaps = 0;
  maps::Maps maps;
  std::vector<PosedScan> scans;
};

/// What `strata learn` makes of them.
Saved learned(const std::vector<Observation>& observations, Saved like) {
  const pipeline::LearnResult result =
      pipeline::learn(observations, {}, {}, {.patch = true, .timescale = false}, 1, 2, nullptr);
  like.maps.occupancy = result.slam.occupancy;
  like.maps.filtered = result.slam.filtered;
  like.maps.patches = result.patches;
  like.scans = result.slam.scans;
  return like;
}

void print_saved(const char* name, const MapQuality& quality) {
  std::cout << "seed " << seed() << ", " << name << ": trajectory " << quality.trajectory_m
            << " m, next day " << quality.localization_m << " m, lost " << quality.lost << ", "
            << quality.submaps << " sub-maps\n";
}

TEST(SavedPatches, AreThoseOfLearnAsLongAsNoScanIsForgotten) {
  const Days days(3);
  Mapper mapper(kKeep);
  for (const Observation& observation : days.observations) mapper.see(observation);
  const Saved saved(mapper.snapshot(), kKeep);
  EXPECT_EQ(saved.live_submaps, 0U);
  const auto& patches = saved.maps.patches->submaps;
  const Saved wanted = learned(days.observations, saved);
  EXPECT_GT(patches.size(), 0U);
  ASSERT_EQ(patches.size(), wanted.maps.patches->submaps.size());
  for (std::size_t i = 0; i < patches.size(); ++i) {
    const patch::Submap& submap = wanted.maps.patches->submaps[i];
    EXPECT_EQ(patches[i].rect, submap.rect) << i;
    EXPECT_EQ(patches[i].configurations.size(), submap.configurations.size()) << i;
  }
}

TEST(SavedPatches, OfAMapperThatWasKilledAreAsGoodAsThoseOfLearn) {
  const Days days(4);
  constexpr std::size_t kLost = 30;  // scans that its state lacks
  constexpr std::size_t kAway = 5;   // while it began again
  Mapper mapper(kKeep);
  std::size_t next = 0;
  for (const std::size_t day : {1U, 2U}) {
    const std::size_t killed = (days.ends[day - 1] + days.ends[day]) / 2;
    std::vector<std::uint8_t> state;
    for (; next < killed; ++next) {
      if (next + kLost == killed) state = mapper.state();
      mapper.see(days.observations[next]);
    }
    next += kAway;
    mapper.begin_again(state, days.observations[next]);
  }
  for (; next < days.observations.size(); ++next) mapper.see(days.observations[next]);
  const scan_matcher::Snapshot snapshot = mapper.snapshot();
  const Saved saved(snapshot, kKeep);
  const MapQuality now = days.quality_of(saved.maps, saved.scans);
  const Saved wanted = learned(days.observations, saved);
  const MapQuality learn = days.quality_of(wanted.maps, wanted.scans);
  print_saved("saved", now);
  print_saved("learn", learn);
  if (std::getenv("STRATA_LIFELONG_SEED") != nullptr) {
    maps::Maps live = saved.maps;
    live.patches->submaps = convert::from_message(*snapshot.patches).submaps;
    print_saved("saved with live patches", days.quality_of(live, saved.scans));
  }
  EXPECT_LT(now.trajectory_m, learn.trajectory_m + 0.03);
  EXPECT_LT(now.localization_m, learn.localization_m + 0.01);
  EXPECT_LE(now.lost, learn.lost);
  EXPECT_LE(now.submaps, learn.submaps + 1);
}

TEST(SavedPatches, AreTheLiveOnesOnceTheMapperHasForgottenScans) {
  const Days days(3);
  constexpr slam::KeepConfig kLittle{.window_scans = 50};
  Mapper mapper(kLittle);
  for (const Observation& observation : days.observations) mapper.see(observation);
  const Saved saved(mapper.snapshot(), kLittle);
  EXPECT_GT(saved.live_submaps, 0U);
  EXPECT_EQ(saved.live_submaps, saved.maps.patches->submaps.size());
}

}  // namespace
}  // namespace strata::test
