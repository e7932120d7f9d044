// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/changes.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "components/maps/map_model.hpp"
#include "core/grid/counting_map.hpp"
#include "tests/core/patch/toy_world.hpp"
#include "tools/pipeline/scan_prediction.hpp"

namespace strata::pipeline {
namespace {

using patch::test_world::ToyRobot;
using patch::test_world::ToyWorld;

/// A hall of 10 m x 4 m with pillars, and one box that stands at x = `box_m`.
ToyWorld hall(double box_m) {
  ToyWorld world;
  world.add_box(0.0, 0.0, 10.0, 4.0);
  world.add_box(2.0, 3.4, 2.4, 3.8);
  world.add_box(7.0, 3.2, 7.4, 3.6);
  world.add_box(box_m, 0.3, box_m + 0.6, 0.9);
  return world;
}

constexpr double kWest = 3.0;
constexpr double kMiddle = 5.0;
constexpr double kEast = 7.5;

/// One run a drive along the hall, with the box where it says.
std::vector<PosedScan> drives(const std::vector<double>& boxes, int first_run) {
  std::vector<PosedScan> scans;
  RandomStream random(7, StreamId::kTest, static_cast<std::uint64_t>(first_run));
  int run = first_run;
  for (const double box_m : boxes) {
    ToyRobot().drive(hall(box_m), {1.0, 2.0, 0.0}, {9.0, 2.0, 0.0}, run, 1000.0 * run, {}, random,
                     scans);
    ++run;
  }
  return scans;
}

struct Tested {
  std::vector<Observation> observations;
  std::vector<std::optional<Pose2>> truths;
};

Tested tested(const std::vector<PosedScan>& scans) {
  Tested result;
  for (const PosedScan& scan : scans) {
    Observation observation;
    observation.run = scan.run;
    observation.scan = scan.scan;
    result.observations.push_back(observation);
    result.truths.emplace_back(scan.map_from_robot);
  }
  return result;
}

ReflectionGrid map_of(const std::vector<PosedScan>& scans) {
  CountingMap map(0.05);
  for (const PosedScan& scan : scans) map.add(scan);
  return map.reflection();
}

Changes changes_of(const std::vector<PosedScan>& learned, const Tested& test) {
  return find_changes(learned, test.observations, test.truths, map_of(learned), {}, 8.0);
}

/// The event at which a box appeared at x, in a run.
const ChangeEvent* appearance(const Changes& changes, const Tested& test, double box_m, int run) {
  const auto found =
      std::find_if(changes.events.begin(), changes.events.end(), [&](const ChangeEvent& event) {
        return std::abs(event.center_m.x() - (box_m + 0.3)) < 0.5 && event.appeared_share > 0.5 &&
               test.observations[event.views.front().scan].run == run;
      });
  return found == changes.events.end() ? nullptr : &*found;
}

TEST(FindChanges, TellsAStateThatCameBackFromOneNeverSeen) {
  const auto learned = drives({kWest, kMiddle, kWest, kMiddle}, 0);
  const Tested test = tested(drives({kWest, kEast}, 4));
  const Changes changes = changes_of(learned, test);
  const ChangeEvent* west = appearance(changes, test, kWest, 4);
  ASSERT_NE(west, nullptr);
  EXPECT_TRUE(west->is_old_state);
  const ChangeEvent* east = appearance(changes, test, kEast, 5);
  ASSERT_NE(east, nullptr);
  EXPECT_FALSE(east->is_old_state);
  EXPECT_TRUE(changes.sees_change(west->views.front().scan));
}

TEST(FindChanges, FindsNothingWhereNothingChanges) {
  const auto learned = drives({kWest, kWest, kWest}, 0);
  const Tested test = tested(drives({kWest, kWest}, 3));
  const Changes changes = changes_of(learned, test);
  EXPECT_TRUE(changes.events.empty());
  for (std::size_t i = 0; i < test.observations.size(); ++i) EXPECT_FALSE(changes.sees_change(i));
}

/// The outcomes of a model that predicts by one grid.
std::vector<EventOutcome> outcomes_of(const ReflectionGrid& map, const Tested& test,
                                      const Changes& changes) {
  maps::Maps maps;
  maps.occupancy = map;
  patch_beams::PatchBeamModelConfig sensor;
  sensor.beam.beams.max_range_m = 8.0;
  const TestScans scans{test.observations, test.truths, &changes};
  return score_predictions(scans, maps::make_map_model(maps, "occupancy", sensor), sensor.beam, {})
      .events;
}

TEST(ScorePredictions, TheMapAsItIsNowAdaptsAtOnceAndTheOldOneNever) {
  const auto learned = drives({kWest, kMiddle, kWest, kMiddle}, 0);
  const auto now = drives({kWest}, 4);
  const Tested test = tested(now);
  const Changes changes = changes_of(learned, test);
  ASSERT_FALSE(changes.events.empty());
  const auto as_it_is = outcomes_of(map_of(now), test, changes);
  const auto as_it_was = outcomes_of(map_of(drives({kMiddle}, 9)), test, changes);
  ASSERT_EQ(as_it_is.size(), changes.events.size());
  for (std::size_t e = 0; e < changes.events.size(); ++e) {
    ASSERT_TRUE(as_it_is[e].adapted_after_scans.has_value());
    EXPECT_LE(*as_it_is[e].adapted_after_scans, 2.0);
    EXPECT_FALSE(as_it_was[e].adapted_after_scans.has_value());
    ASSERT_TRUE(as_it_is[e].recall && as_it_was[e].recall);
    EXPECT_GT(*as_it_is[e].recall, -0.1);
    EXPECT_LT(*as_it_was[e].recall, *as_it_is[e].recall - 0.1);
  }
}

}  // namespace
}  // namespace strata::pipeline
