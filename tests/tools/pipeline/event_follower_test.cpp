// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/event_follower.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

namespace strata::pipeline {
namespace {

constexpr double kBefore_m = 3.0;
constexpr double kNow_m = 2.0;
constexpr std::size_t kBeams = 8;

/// Eight scans, one a second, in which all eight beams measure kNow_m; the second to the last show
/// a change.
struct Drive {
  std::vector<Observation> observations;
  std::vector<std::optional<Pose2>> truths;
  Changes changes;

  Drive() {
    changes.events.emplace_back();
    for (std::size_t i = 0; i < 8; ++i) {
      Observation observation;
      observation.scan.angle_min_rad = -1.0F;
      observation.scan.angle_increment_rad = 0.2F;
      observation.scan.range_max_m = 8.0F;
      observation.scan.ranges_m.assign(kBeams, static_cast<float>(kNow_m));
      observation.scan.stamp = Stamp::from_seconds(1.0 + static_cast<double>(i));
      observations.push_back(observation);
      truths.emplace_back(Pose2{});
      if (i == 0) continue;
      ChangeView view;
      view.scan = i;
      for (std::uint32_t beam = 0; beam < kBeams; ++beam) {
        view.beams.push_back(beam);
        view.before_m.push_back(static_cast<float>(kBefore_m));
      }
      changes.events.front().views.push_back(view);
    }
  }
  [[nodiscard]] TestScans test() const { return {observations, truths, &changes}; }
};

/// A prediction that has the first `now` of the beams as they are now, and the rest as before.
maps::RangeFunction half_way(std::size_t now) {
  return [now](const Pose2& /*map_from_laser*/, double bearing_rad) {
    const auto beam = static_cast<std::size_t>(std::lround((bearing_rad + 1.0) / 0.2));
    return beam < now ? kNow_m : kBefore_m;
  };
}

EventOutcome follow(const Drive& drive, const std::array<std::size_t, 7>& right_beams) {
  const TestScans test = drive.test();
  EventFollower follower(test, 0.0);
  for (std::size_t v = 0; v < right_beams.size(); ++v) {
    follower.see(v + 1, half_way(right_beams[v]));
  }
  return follower.take().front();
}

TEST(EventFollower, IsAdaptedFromTheFirstOfFiveScansThatTogetherAreNineTenthsRight) {
  const Drive drive;
  const EventOutcome outcome = follow(drive, {0, 0, 8, 8, 8, 8, 8});
  ASSERT_TRUE(outcome.adapted_after_scans);
  EXPECT_EQ(*outcome.adapted_after_scans, 2.0);
  EXPECT_DOUBLE_EQ(outcome.adapted_after_s.value(), 2.0);
  // 36 of 40 bins are nine tenths, 35 are not.
  EXPECT_EQ(follow(drive, {4, 8, 8, 8, 8, 0, 0}).adapted_after_scans, 0.0);
  EXPECT_FALSE(follow(drive, {3, 8, 8, 8, 8, 0, 0}).adapted_after_scans);
}

TEST(EventFollower, MixedIsAQuarterOfEachState) {
  const Drive drive;
  EXPECT_DOUBLE_EQ(follow(drive, {0, 0, 0, 8, 8, 8, 8}).mixed_share, 0.0);
  EXPECT_DOUBLE_EQ(follow(drive, {0, 2, 4, 6, 8, 8, 8}).mixed_share, 3.0 / 7.0);
  EXPECT_DOUBLE_EQ(follow(drive, {1, 1, 1, 7, 7, 7, 7}).mixed_share, 0.0);
}

TEST(EventFollower, LimitsWhatIsExpectedAndMeasuredAlike) {
  Drive drive;
  for (Observation& observation : drive.observations) {
    observation.scan.ranges_m.assign(kBeams, 7.5F);
  }
  const TestScans test = drive.test();
  EventFollower follower(test, 5.0);
  for (std::size_t scan = 1; scan < 8; ++scan) {
    follower.see(scan, [](const Pose2&, double) { return 6.0; });
  }
  EXPECT_EQ(follower.take().front().adapted_after_scans, 0.0);
}

/// A sub-map of one row of cells from `from` on, whose configurations are rows of 0 and 1.
patch::Submap row_submap(int from, const std::vector<std::vector<float>>& rows) {
  patch::Submap submap;
  submap.rect = {{from, 0}, {from + static_cast<int>(rows.front().size()), 1}};
  for (const std::vector<float>& row : rows) {
    patch::Configuration configuration;
    configuration.reflection = ReflectionGrid(0.1, submap.rect, 0.0F);
    std::copy(row.begin(), row.end(), configuration.reflection.values().begin());
    submap.configurations.push_back(configuration);
  }
  return submap;
}

/// One of five cells, with this configuration and an empty one.
patch::Submap wide_submap(const std::vector<float>& row) {
  return row_submap(0, {row, {0, 0, 0, 0, 0}});
}

TEST(BeliefInState, AddsTheConfigurationsThatShowWhatChangedAsItIs) {
  patch::PatchMap map;
  map.base = ReflectionGrid(0.1, {{0, 0}, {20, 1}}, 0.0F);
  // Nothing, a box at the left, one at the right.
  map.submaps = {row_submap(0, {{0, 0, 0, 0}, {1, 1, 0, 0}, {0, 0, 1, 1}})};
  const std::vector<localization::SubmapBelief> beliefs{{0, 1.0, {0.1, 0.3, 0.6}}};
  ChangeEvent event;
  event.changed = {{0, 0}, {1, 0}};
  event.occupied = {0, 0};
  // Whether there is a box at the right does not matter for the left.
  EXPECT_DOUBLE_EQ(belief_in_state(event, map, beliefs).value(), 0.7);
  event.occupied = {1, 1};
  EXPECT_DOUBLE_EQ(belief_in_state(event, map, beliefs).value(), 0.3);
  event.occupied = {1, 0};
  EXPECT_FALSE(belief_in_state(event, map, beliefs)) << "no configuration shows that";
  event.changed = {{0, 0}, {5, 0}, {6, 0}};
  event.occupied = {1, 0, 0};
  EXPECT_FALSE(belief_in_state(event, map, beliefs)) << "two thirds lie outside";
}

TEST(BeliefInState, AsksTheSubmapThatShowsItBest) {
  patch::PatchMap map;
  map.base = ReflectionGrid(0.1, {{0, 0}, {20, 1}}, 0.0F);
  map.submaps = {row_submap(0, {{1, 1, 1, 1}, {0, 0, 0, 0}}),
                 row_submap(1, {{1, 1, 1, 0}, {0, 0, 0, 0}})};
  const std::vector<localization::SubmapBelief> beliefs{{0, 1.0, {0.2, 0.8}}, {1, 1.0, {0.9, 0.1}}};
  ChangeEvent event;
  event.changed = {{1, 0}, {2, 0}, {3, 0}, {4, 0}};
  event.occupied = {1, 1, 1, 0};
  EXPECT_DOUBLE_EQ(belief_in_state(event, map, beliefs).value(), 0.2) << "equally good: the first";
  // Of five cells the first shows four as they are, as much as a configuration must, the second
  // all.
  map.submaps = {wide_submap({1, 1, 1, 1, 1}), wide_submap({1, 1, 1, 1, 0})};
  event.changed = {{0, 0}, {1, 0}, {2, 0}, {3, 0}, {4, 0}};
  event.occupied = {1, 1, 1, 1, 0};
  EXPECT_DOUBLE_EQ(belief_in_state(event, map, beliefs).value(), 0.9);
  map.submaps.pop_back();
  EXPECT_DOUBLE_EQ(belief_in_state(event, map, beliefs).value(), 0.2) << "four fifths are enough";
  event.occupied = {1, 1, 1, 0, 0};
  EXPECT_FALSE(belief_in_state(event, map, beliefs)) << "three are not";
}

}  // namespace
}  // namespace strata::pipeline
