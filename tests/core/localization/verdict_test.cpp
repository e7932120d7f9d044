// SPDX-License-Identifier: Apache-2.0
// What the localizer says of itself: that it is lost, that the map is outdated here, or neither.
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "core/localization/likelihood_field_model.hpp"
#include "core/localization/localizer.hpp"
#include "core/localization/range_provider_model.hpp"
#include "core/patch_beams/patch_beam_model.hpp"
#include "tests/core/localization/box_map.hpp"

namespace strata::localization {
namespace {

using test::BoxWorld;
using test::Drive;
using test::room;

/// The map of the room, unknown from x = `known_m` on.
ReflectionGrid map_up_to(double known_m) {
  ReflectionGrid map = test::rasterize(room(), 0.05, test::kRect);
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (map.center(map.cell(i)).x() > known_m) map.values()[i] = kUnknownReflection;
  }
  return map;
}

enum class Model { kGrid, kField, kPatch };

std::shared_ptr<const SensorModel> make_model(Model model, const ReflectionGrid& map) {
  if (model == Model::kGrid) return make_grid_beam_model(map);
  if (model == Model::kField) return std::make_shared<LikelihoodFieldModel>(map);
  // One sub-map at the near end, so that its configurations are asked as well.
  auto patches = std::make_shared<patch::PatchMap>();
  patches->base = map;
  BoxWorld without = room();
  without.erase(without.begin() + 4);
  patches->submaps.push_back(test::submap_of(0, {{30, 0}, {62, 40}}, {room(), without}));
  patch_beams::PatchBeamModelConfig config;
  config.states.memory = PatchMemory::kPerParticle;
  return std::make_shared<patch_beams::PatchBeamModel>(patches, config);
}

class Verdict : public testing::TestWithParam<Model> {
 protected:
  /// Tracks from the true place on.
  static Localizer started(const ReflectionGrid& map, const Drive& drive) {
    LocalizerConfig config;
    config.particles = 300;
    config.adaptive = false;
    config.gating.every_scans = 1;
    Localizer localizer(config, make_model(GetParam(), map), 3, 1);
    localizer.initialize({drive.truth(), Eigen::Vector3d(0.01, 0.01, 0.001).asDiagonal()});
    return localizer;
  }
};

double error_m(const LocalizationResult& result, const Drive& drive) {
  return (result.pose.mean.translation() - drive.truth().translation()).norm();
}

/// What a model says of one beam.
InlierShares inlier_shares(const SensorModel& model, const Pose2& robot, double bearing_rad,
                           float range_m) {
  Scan scan;
  scan.angle_min_rad = static_cast<float>(bearing_rad);
  scan.range_max_m = 10.0F;
  scan.ranges_m = {range_m};
  ParticleSet particles;
  particles.resize(1);
  set_uniform_weights(particles);
  if (model.patch_states() != nullptr) model.patch_states()->prepare(particles);
  return model.inlier_shares(scan, robot, particles);
}

TEST_P(Verdict, JudgesNoBeamThatEndsInTheUnknownWithoutAnObstacleBefore) {
  const std::shared_ptr<const SensorModel> model = make_model(GetParam(), map_up_to(5.0));
  const double left = std::numbers::pi / 2.0;
  const auto expect = [&](double bearing_rad, float range_m, double inlier, double judged) {
    const InlierShares said = inlier_shares(*model, {3.0, 2.2, 0.0}, bearing_rad, range_m);
    EXPECT_NEAR(said.inlier, inlier, 1e-6) << range_m;
    EXPECT_NEAR(said.judged, judged, 1e-6) << range_m;
  };
  expect(0.0, 4.0F, 0.0, 0.0);              // beyond the map's end, with nothing before it
  expect(0.0, 1.0F, 0.0, 1.0);              // in space that is known to be free
  expect(left, 1.5F, 1.0, 1.0);             // at the wall
  expect(left, 3.0F, 0.0, 1.0);             // beyond the wall
  if (GetParam() == Model::kField) return;  // which does not use what has no end
  const float never = std::numeric_limits<float>::infinity();
  expect(0.0, never, 1.0, 1.0);
  expect(left, never, 0.0, 1.0);
  EXPECT_EQ(inlier_shares(*model, {40.0, 2.2, 0.0}, 0.0, never).judged, 0.0);
}

TEST_P(Verdict, IsNotLostWhereTheMapEnds) {
  Drive drive({1.5, 2.2, 0.0}, 5);
  Localizer localizer = started(map_up_to(5.0), drive);
  for (int n = 0; n < 65; ++n) {
    drive.step({0.1, 0.0, 0.0});
    const LocalizationResult result = localizer.update(drive.look(room()));
    ASSERT_NE(result.health.state, HealthState::kLost) << drive.truth().x;
    ASSERT_LT(error_m(result, drive), 0.4) << drive.truth().x;
  }
  EXPECT_GT(drive.truth().x, 7.9);
  EXPECT_LT(localizer.update(drive.look(room())).health.judged_share_fast, 0.8);
}

TEST_P(Verdict, IsLostAfterTheRobotWasKidnapped) {
  Drive drive({1.5, 2.2, 0.0}, 6);
  Localizer localizer = started(map_up_to(10.0), drive);
  for (int n = 0; n < 30; ++n) {
    drive.step({0.05, 0.0, 0.0});
    ASSERT_EQ(localizer.update(drive.look(room())).health.state, HealthState::kGood);
  }
  drive.kidnap({8.5, 1.2, 1.0});
  LocalizationResult result;
  for (int n = 0; n < 15; ++n) {
    drive.step({0.0, 0.0, 0.0});
    result = localizer.update(drive.look(room()));
  }
  EXPECT_GT(error_m(result, drive), 1.0);
  EXPECT_EQ(result.health.state, HealthState::kLost);
}

TEST_P(Verdict, SaysThatTheMapIsOutdatedWhereThingsWerePutDown) {
  Drive drive({1.5, 2.2, 0.0}, 7);
  Localizer localizer = started(map_up_to(10.0), drive);
  for (int n = 0; n < 100; ++n) {
    drive.step({0.01, 0.0, 0.0});
    ASSERT_EQ(localizer.update(drive.look(room())).health.state, HealthState::kGood);
  }
  BoxWorld changed = room();
  changed.push_back({3.9, 1.6, 4.2, 2.8});
  changed.push_back({2.2, 2.9, 2.5, 3.1});
  LocalizationResult result;
  for (int n = 0; n < 15; ++n) {
    drive.step({0.02, 0.0, 0.0});
    result = localizer.update(drive.look(changed));
  }
  EXPECT_LT(error_m(result, drive), 0.15);
  EXPECT_EQ(result.health.state, HealthState::kMapOutdated) << result.health.inlier_share_fast;
}

BoxWorld furnished(std::initializer_list<test::Box> furniture) {
  BoxWorld world = room();
  world.insert(world.end(), furniture);
  return world;
}
BoxWorld furnished() {
  return furnished({{3.4, 0.3, 4.4, 1.2},
                    {5.2, 0.3, 6.6, 1.2},
                    {3.2, 2.8, 3.9, 3.7},
                    {4.6, 2.8, 6.2, 3.7},
                    {8.2, 0.3, 9.2, 1.1},
                    {8.6, 2.4, 9.7, 3.2}});
}
BoxWorld furnished_otherwise() {
  return furnished({{4.5, 0.3, 5.1, 1.3},
                    {6.8, 0.3, 7.8, 1.3},
                    {4.0, 2.9, 4.5, 3.7},
                    {6.3, 3.0, 6.9, 3.7},
                    {9.1, 1.3, 9.7, 2.2},
                    {7.9, 2.9, 8.5, 3.7}});
}

/// What is said after a drive through a room that has become `now` since it was mapped. Expects
/// that the robot was never called lost.
LocalizationHealth after_a_change(Localizer& localizer, Drive& drive, const BoxWorld& mapped,
                                  const BoxWorld& now) {
  for (int n = 0; n < 100; ++n) {
    drive.step({0.005, 0.0, 0.0});
    localizer.update(drive.look(mapped));
  }
  LocalizationResult result;
  for (int n = 0; n < 30; ++n) {
    drive.step({0.03, 0.0, 0.0});
    result = localizer.update(drive.look(now));
    EXPECT_NE(result.health.state, HealthState::kLost) << drive.truth().x;
  }
  EXPECT_LT(error_m(result, drive), 0.4);
  return result.health;
}

TEST_P(Verdict, SaysThatTheMapIsOutdatedWhereTheFurnitureOfARoomStandsOtherwise) {
  const std::pair<BoxWorld, BoxWorld> changes[] = {{furnished_otherwise(), furnished()},
                                                   {room(), furnished()},
                                                   {room(), furnished_otherwise()},
                                                   {furnished(), room()}};
  for (const auto& [mapped, now] : changes) {
    Drive drive({2.9, 2.0, 0.0}, 8);
    Localizer localizer = started(test::rasterize(mapped, 0.05, test::kRect), drive);
    const LocalizationHealth said = after_a_change(localizer, drive, mapped, now);
    // Whatever is taken away, there is a wall near where a beam ends.
    if (GetParam() == Model::kField && now.size() == room().size()) continue;
    EXPECT_EQ(said.state, HealthState::kMapOutdated);
    EXPECT_LT(said.inlier_share_fast, 0.8 * said.inlier_share_slow);
  }
}

TEST_P(Verdict, IsLostAfterTheRobotWasKidnappedWithinASmallRoom) {
  const BoxWorld small{{0.0, 0.0, 4.2, 0.3}, {0.0, 3.2, 4.2, 3.5}, {0.0, 0.0, 0.3, 3.5},
                       {3.9, 0.0, 4.2, 3.5}, {0.3, 0.3, 1.1, 0.9}, {2.6, 2.5, 3.9, 3.2}};
  for (const Pose2& to : {Pose2{3.0, 1.0, 2.0}, Pose2{1.0, 2.5, 0.5}, Pose2{3.2, 1.8, -1.0},
                          Pose2{0.8, 1.8, -1.5}, Pose2{3.0, 0.9, -2.0}}) {
    Drive drive({1.0, 1.8, 0.0}, 9);
    Localizer localizer = started(test::rasterize(small, 0.05, {{0, 0}, {84, 70}}), drive);
    for (int n = 0; n < 60; ++n) {
      drive.step({0.02, 0.0, 0.0});
      ASSERT_EQ(localizer.update(drive.look(small)).health.state, HealthState::kGood);
    }
    drive.kidnap(to);
    bool was_lost = false;
    for (int n = 0; n < 10; ++n) {
      drive.step({0.0, 0.0, 0.1});
      was_lost |= localizer.update(drive.look(small)).health.state == HealthState::kLost;
    }
    EXPECT_TRUE(was_lost) << to.x;
  }
}

TEST_P(Verdict, TellsBeamsThatGoOnAndBeamsThatAreStoppedFromOthers) {
  // A box stands across the room.
  const ReflectionGrid map = test::rasterize(furnished({{5.0, 1.5, 5.5, 3.0}}), 0.05, test::kRect);
  const std::shared_ptr<const SensorModel> model = make_model(GetParam(), map);
  const auto expect = [&](float range_m, double met, double at_surface, double stopped) {
    const InlierShares said = inlier_shares(*model, {4.0, 2.2, 0.0}, 0.0, range_m);
    EXPECT_NEAR(said.met, met, 1e-6) << range_m;
    EXPECT_NEAR(said.at_surface, at_surface, 1e-6) << range_m;
    EXPECT_NEAR(said.stopped, stopped, 1e-6) << range_m;
    EXPECT_NEAR(said.judged, 1.0, 1e-6) << range_m;
  };
  expect(1.0F, 1.0, 1.0, 0.0);  // at the box
  expect(5.7F, 0.0, 1.0, 0.0);  // at the wall behind it
  expect(3.5F, 0.0, 0.0, 0.0);  // behind it, where nothing is
  expect(0.5F, 0.0, 0.0, 1.0);  // before it
}

INSTANTIATE_TEST_SUITE_P(Models, Verdict,
                         testing::Values(Model::kGrid, Model::kField, Model::kPatch),
                         [](const testing::TestParamInfo<Model>& tested) {
                           return std::string(tested.param == Model::kGrid    ? "Grid"
                                              : tested.param == Model::kField ? "Field"
                                                                              : "Patch");
                         });

}  // namespace
}  // namespace strata::localization
