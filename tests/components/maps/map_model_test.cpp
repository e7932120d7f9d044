// SPDX-License-Identifier: Apache-2.0
#include "components/maps/map_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/maps/timescale_model.hpp"
#include "core/base/error.hpp"
#include "core/base/parallel.hpp"
#include "core/localization/patch_states.hpp"
#include "core/random/stream.hpp"
#include "tests/components/maps/learned_room.hpp"

namespace strata::maps {
namespace {

using localization::ParticleSet;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Particles at these poses, with whatever memory the model keeps in them.
ParticleSet particles_at(const MapModel& model, const std::vector<Pose2>& poses) {
  ParticleSet particles;
  particles.resize(poses.size());
  set_uniform_weights(particles);
  for (std::size_t i = 0; i < poses.size(); ++i) particles.set_pose(i, poses[i]);
  const localization::PatchStates* states = model.sensor->patch_states();
  if (states == nullptr) return particles;
  states->prepare(particles);
  RandomStream random(1, StreamId::kTest);
  for (std::size_t i = 0; i < poses.size(); ++i) states->draw(particles, i, random);
  return particles;
}

template <typename E>
std::string message_of(const Maps& maps, const std::string& name) {
  try {
    static_cast<void>(make_map_model(maps, name, {}));
  } catch (const E& error) {
    return error.what();
  }
  return "";
}

TEST(MapModels, AreNamedAfterThePartsThatWereLearned) {
  EXPECT_THAT(model_names(Maps{}), IsEmpty());
  Maps maps = test_room::make_maps();
  EXPECT_THAT(
      model_names(maps),
      ElementsAre("occupancy", "filtered", "patch", "patch_paper", "patch_shared",
                  "patch_per_particle", "timescale", "timescale_mixture", "timescale_frozen",
                  "timescale_short", "timescale_mid", "timescale_long", "cells"));
  maps.patches.reset();
  maps.timescale.reset();
  EXPECT_THAT(model_names(maps), ElementsAre("occupancy", "filtered", "cells"));
  maps.visit_scans = nullptr;
  EXPECT_THAT(model_names(maps), ElementsAre("occupancy", "filtered"));
}

TEST(MapModels, OfAMemoryShowItAsTheMapsSayThatItIsDecoded) {
  Maps maps = test_room::make_maps();
  maps.decoding = memory::scene_decoding();
  const MapModel model = make_map_model(maps, "timescale", {});
  const auto* sensor = dynamic_cast<const TimescaleModel*>(model.sensor.get());
  ASSERT_NE(sensor, nullptr);
  EXPECT_EQ(sensor->map().decoding(), memory::scene_decoding());
}

TEST(MapModels, OfEveryNameExpectTheWallWhereItIsAndPreferTheTruePose) {
  const Maps maps = test_room::make_maps();
  const Pose2 truth{-1.5, 0.2, 0.2};
  const Scan scan = memory::test_world::observe(truth, 9000.0, true, 5).scan;
  WorkerPool pool(1);
  for (const std::string& name : model_names(maps)) {
    SCOPED_TRACE(name);
    const MapModel model = make_map_model(maps, name, {});
    EXPECT_EQ(model.name, name);
    EXPECT_GT(model.bytes, 0U);
    ParticleSet particles = particles_at(model, {truth, {-1.1, -0.3, 0.2}});
    // Away from the box, every map knows the wall at x = -4.
    const RangeFunction expected_range_m = model.best_prediction(particles);
    EXPECT_NEAR(expected_range_m(truth, std::numbers::pi - truth.theta), 2.5, 0.15);

    std::vector<double> log_likelihood(2, 0.0);
    EXPECT_GT(model.sensor->log_likelihoods(scan, {1.0}, particles, log_likelihood, pool), 0U);
    EXPECT_GT(log_likelihood[0], log_likelihood[1]);
  }
}

TEST(MapModels, OfEveryNameJudgeBeamsWhereTheyKnowTheRoomAndHardlyAnyFarOutside) {
  const Maps maps = test_room::make_maps();
  const Pose2 inside{-1.5, 0.2, 0.2};
  const Scan scan = memory::test_world::observe(inside, 9000.0, true, 5).scan;
  for (const std::string& name : model_names(maps)) {
    SCOPED_TRACE(name);
    const MapModel model = make_map_model(maps, name, {});
    const ParticleSet particles = particles_at(model, {inside});
    const localization::InlierShares here = model.sensor->inlier_shares(scan, inside, particles);
    EXPECT_GT(here.inlier, 0.7);
    EXPECT_GE(here.judged, here.inlier);
    const localization::InlierShares away =
        model.sensor->inlier_shares(scan, {60.0, 60.0, 0.0}, particles);
    EXPECT_LT(away.judged, 0.05);
  }
}

/// What a model says of one beam along x from a pose.
localization::InlierShares judge_beam(const MapModel& model, const Pose2& robot, float range_m) {
  Scan scan;
  scan.range_max_m = 30.0F;
  scan.ranges_m = {range_m};
  return model.sensor->inlier_shares(scan, robot, particles_at(model, {robot}));
}

TEST(MapModels, OfAGivenMapKnowItsSurfacesWhereItLies) {
  Maps maps = test_room::make_maps();
  // Free, with a plate at 1 m and a wall at 3 m of its own frame, which is turned and far away.
  maps.given = ReflectionGrid(0.05, {{-20, -40}, {100, 40}}, 0.0F);
  for (int y = -10; y < 10; ++y) maps.given.at({20, y}) = 0.9F;
  for (int y = -40; y < 40; ++y) maps.given.at({60, y}) = 0.9F;
  maps.given_from_map = Pose2{50.0, -7.0, 1.2};
  const MapModel model = make_map_model(maps, "map", {});
  const Pose2 robot = inverse(maps.given_from_map);
  const auto expect = [&](float range_m, double met, double at_surface, double stopped) {
    const localization::InlierShares said = judge_beam(model, robot, range_m);
    EXPECT_EQ(said.met, met) << range_m;
    EXPECT_EQ(said.at_surface, at_surface) << range_m;
    EXPECT_EQ(said.stopped, stopped) << range_m;
  };
  expect(1.0F, 1.0, 1.0, 0.0);  // at the plate
  expect(3.0F, 0.0, 1.0, 0.0);  // at the wall behind it
  expect(2.0F, 0.0, 0.0, 0.0);  // between both
  expect(0.5F, 0.0, 0.0, 1.0);  // before the plate
}

TEST(MapModels, OfAMemoryTellBeamsThatAreStoppedBeforeEveryLevelsSurface) {
  const Maps maps = test_room::make_maps();
  for (const char* const name : {"timescale_short", "timescale_long", "timescale"}) {
    SCOPED_TRACE(name);
    const MapModel model = make_map_model(maps, name, {});
    // Looks along y past the box's place, at the wall 2.8 m away.
    const Pose2 robot{-1.5, 0.2, 0.5 * std::numbers::pi};
    const auto expect = [&](float range_m, double met, double stopped) {
      const localization::InlierShares said = judge_beam(model, robot, range_m);
      EXPECT_EQ(said.judged, 1.0) << range_m;
      EXPECT_EQ(said.met, met) << range_m;
      EXPECT_EQ(said.at_surface, met) << range_m;
      EXPECT_EQ(said.stopped, stopped) << range_m;
    };
    expect(2.8F, 1.0, 0.0);
    expect(1.2F, 0.0, 1.0);
    expect(4.5F, 0.0, 0.0);  // through the wall
    expect(std::numeric_limits<float>::infinity(), 0.0, 0.0);
  }
}

TEST(MapModels, OfSubmapsByPlacesHaveTheirOwnPatchMap) {
  Maps maps = test_room::make_maps();
  EXPECT_THAT(message_of<InputError>(maps, "patch_places"), HasSubstr("not in these maps"));
  std::swap(maps.patches, maps.place_patches);
  EXPECT_THAT(model_names(maps), testing::Contains("patch_places"));
  EXPECT_THAT(message_of<InputError>(maps, "patch"), HasSubstr("not in these maps"));
  const MapModel model = make_map_model(maps, "patch_places", {});
  EXPECT_EQ(model.sensor->patch_states()->map().submaps.size(), 1U);
}

TEST(MapModels, OfPatchesExpectTheConfigurationThatTheScansShow) {
  const Maps maps = test_room::make_maps();
  const Pose2 robot{-1.5, 0.2, 0.0};
  WorkerPool pool(1);
  for (const bool with_box : {true, false}) {
    const MapModel model = make_map_model(maps, "patch_per_particle", {});
    ParticleSet particles = particles_at(model, {robot});
    std::vector<double> log_likelihood(1, 0.0);
    model.sensor->log_likelihoods(memory::test_world::observe(robot, 9000.0, with_box).scan, {1.0},
                                  particles, log_likelihood, pool);
    // The box begins at x = 2, the wall behind it at x = 5.
    EXPECT_NEAR(model.best_prediction(particles)(robot, 0.0), with_box ? 3.5 : 6.5, 0.1);
  }
}

TEST(MapModels, CountAByteACellOfEveryGrid) {
  Maps maps = test_room::make_maps();
  EXPECT_EQ(make_map_model(maps, "occupancy", {}).bytes, maps.occupancy.size());
  EXPECT_EQ(make_map_model(maps, "patch", {}).bytes,
            maps.patches->base.size() + 2 * maps.patches->submaps[0].rect.area());
  EXPECT_EQ(make_map_model(maps, "timescale", {}).bytes,
            maps.timescale->bytes() + maps.filtered.size());
  maps.timescale_use.base_map = false;
  EXPECT_EQ(make_map_model(maps, "timescale", {}).bytes, maps.timescale->bytes());
}

TEST(MapModels, RefuseAnUnknownNameAndListTheKnownOnes) {
  const Maps maps = test_room::make_maps();
  for (const char* name : {"octomap", "patch_paperr", "Filtered", ""}) {
    const std::string message = message_of<ConfigError>(maps, name);
    EXPECT_THAT(message, HasSubstr("occupancy, filtered, patch, patch_paper")) << name;
    EXPECT_THAT(message, HasSubstr("timescale_long")) << name;
  }
  EXPECT_THAT(message_of<ConfigError>(maps, "timescale_hourly"), HasSubstr("short, mid, long"));
}

TEST(MapModels, RefuseAMapThatWasNotLearned) {
  for (const char* name : {"occupancy", "filtered", "patch", "patch_shared", "timescale"}) {
    EXPECT_THAT(message_of<InputError>(Maps{}, name), HasSubstr("is not in these maps")) << name;
  }
}

TEST(MapModels, OfEndPointsPreferTheTruePoseInEitherGrid) {
  const Maps maps = test_room::make_maps();
  const Pose2 truth{-1.5, 0.2, 0.2};
  const Scan scan = memory::test_world::observe(truth, 9000.0, true, 5).scan;
  WorkerPool pool(1);
  for (const char* name : {"occupancy", "filtered"}) {
    SCOPED_TRACE(name);
    const MapModel model = make_likelihood_field_model(maps, name, {});
    EXPECT_EQ(model.name, name);
    ParticleSet particles = particles_at(model, {truth, {-1.1, -0.3, 0.2}});
    EXPECT_NEAR(model.best_prediction(particles)(truth, std::numbers::pi - truth.theta), 2.5, 0.15);
    std::vector<double> log_likelihood(2, 0.0);
    EXPECT_GT(model.sensor->log_likelihoods(scan, {1.0}, particles, log_likelihood, pool), 0U);
    EXPECT_GT(log_likelihood[0], log_likelihood[1]);
  }
}

TEST(MapModels, OfEndPointsAreRefusedWhereBeamsMustBeTraced) {
  const Maps maps = test_room::make_maps();
  for (const char* name : {"patch", "timescale", "octomap"}) {
    EXPECT_THROW(static_cast<void>(make_likelihood_field_model(maps, name, {})), ConfigError);
  }
  EXPECT_THROW(static_cast<void>(make_likelihood_field_model(Maps{}, "filtered", {})), InputError);
}

}  // namespace
}  // namespace strata::maps
