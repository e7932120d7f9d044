// SPDX-License-Identifier: Apache-2.0
#include "components/maps/map_model.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/base/parallel.hpp"
#include "core/localization/patch_states.hpp"
#include "core/random/stream.hpp"
#include "tests/components/maps/learned_room.hpp"

namespace strata::maps {
namespace {

using localization::ParticleSet;
using localization::PatchBeamModelConfig;
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
  EXPECT_THAT(model_names(maps),
              ElementsAre("occupancy", "filtered", "patch", "patch_paper", "patch_shared",
                          "patch_per_particle", "timescale", "timescale_mixture", "timescale_short",
                          "timescale_mid", "timescale_long"));
  maps.patches.reset();
  maps.timescale.reset();
  EXPECT_THAT(model_names(maps), ElementsAre("occupancy", "filtered"));
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
    EXPECT_GT(model.sensor->log_likelihoods(scan, 1.0, particles, log_likelihood, pool), 0U);
    EXPECT_GT(log_likelihood[0], log_likelihood[1]);
  }
}

TEST(MapModels, OfPatchesExpectTheConfigurationThatTheScansShow) {
  const Maps maps = test_room::make_maps();
  const Pose2 robot{-1.5, 0.2, 0.0};
  WorkerPool pool(1);
  for (const bool with_box : {true, false}) {
    const MapModel model = make_map_model(maps, "patch_per_particle", {});
    ParticleSet particles = particles_at(model, {robot});
    std::vector<double> log_likelihood(1, 0.0);
    model.sensor->log_likelihoods(memory::test_world::observe(robot, 9000.0, with_box).scan, 1.0,
                                  particles, log_likelihood, pool);
    // The box begins at x = 2, the wall behind it at x = 5.
    EXPECT_NEAR(model.best_prediction(particles)(robot, 0.0), with_box ? 3.5 : 6.5, 0.1);
  }
}

TEST(MapModels, CountAByteACellOfEveryGrid) {
  const Maps maps = test_room::make_maps();
  EXPECT_EQ(make_map_model(maps, "occupancy", {}).bytes, maps.occupancy.size());
  EXPECT_EQ(make_map_model(maps, "patch", {}).bytes,
            maps.patches->base.size() + 2 * maps.patches->submaps[0].rect.area());
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
    EXPECT_GT(model.sensor->log_likelihoods(scan, 1.0, particles, log_likelihood, pool), 0U);
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
