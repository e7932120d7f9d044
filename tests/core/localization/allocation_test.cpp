// SPDX-License-Identifier: Apache-2.0
// Has a program of its own, whose allocations it counts.
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "core/localization/likelihood_field_model.hpp"
#include "core/localization/localizer.hpp"
#include "core/localization/range_provider_model.hpp"
#include "core/patch_beams/patch_beam_model.hpp"
#include "tests/core/localization/box_world.hpp"
#include "tests/support/counted_allocations.hpp"

namespace strata::localization {
namespace {

using test::allocations;

test::BoxWorld room() {
  return {{0.0, 0.0, 8.0, 0.2},
          {0.0, 4.8, 8.0, 5.0},
          {0.0, 0.0, 0.2, 5.0},
          {7.8, 0.0, 8.0, 5.0},
          {2.5, 0.0, 2.7, 2.0}};
}
ReflectionGrid room_map() { return test::rasterize(room(), 0.05, {{0, 0}, {160, 100}}); }

/// A sub-map in which the pillar stands or does not.
std::shared_ptr<const patch::PatchMap> patch_map() {
  auto map = std::make_shared<patch::PatchMap>();
  map->base = room_map();
  patch::Submap submap;
  submap.rect = {{40, 0}, {70, 60}};
  for (const bool has_pillar : {true, false}) {
    test::BoxWorld world = room();
    if (!has_pillar) world.pop_back();
    patch::Configuration configuration;
    configuration.reflection =
        test::rasterize(world, 0.05, {{0, 0}, {160, 100}}).cropped(submap.rect);
    configuration.prior = 0.5;
    submap.configurations.push_back(configuration);
  }
  map->submaps.push_back(submap);
  return map;
}

/// Allocations of 100 updates after 100 for warming up.
std::size_t allocations_of(const std::shared_ptr<const SensorModel>& model, bool is_adaptive) {
  test::Drive drive({4.0, 1.2, 0.0}, 31);
  std::vector<Observation> observations;
  for (int n = 0; n < 200; ++n) {
    drive.step({0.12, 0.0, 0.12});
    observations.push_back(drive.look(room()));
  }
  LocalizerConfig config;
  config.adaptive = is_adaptive;
  config.particles = is_adaptive ? 2000 : 300;
  config.recovery = kidnapping_recovery();
  Localizer localizer(config, model, 1);
  localizer.set_free_space(room_map());
  localizer.initialize({{4.0, 1.2, 0.0}, Eigen::Vector3d(0.04, 0.04, 0.01).asDiagonal()});
  for (int n = 0; n < 100; ++n) localizer.update(observations[static_cast<std::size_t>(n)]);
  const std::size_t before = allocations;
  for (int n = 100; n < 200; ++n) localizer.update(observations[static_cast<std::size_t>(n)]);
  return allocations - before;
}

TEST(Allocations, AreCounted) {
  const std::size_t before = allocations;
  const auto one = std::make_unique<int>(1);
  EXPECT_EQ(allocations, before + 1);
  EXPECT_EQ(*one, 1);
}

TEST(Localizer, AllocatesNothingPerScanWithTheLikelihoodField) {
  const auto model = std::make_shared<LikelihoodFieldModel>(room_map());
  EXPECT_EQ(allocations_of(model, false), 0U);
  EXPECT_EQ(allocations_of(model, true), 0U);
}

TEST(Localizer, AllocatesNothingPerScanWithTheBeamModel) {
  EXPECT_EQ(allocations_of(make_grid_beam_model(room_map()), false), 0U);
}

TEST(Localizer, AllocatesNothingPerScanWithPatches) {
  for (const PatchMemory memory :
       {PatchMemory::kNone, PatchMemory::kShared, PatchMemory::kPerParticle}) {
    patch_beams::PatchBeamModelConfig config;
    config.states.memory = memory;
    EXPECT_EQ(
        allocations_of(std::make_shared<patch_beams::PatchBeamModel>(patch_map(), config), false),
        0U);
  }
}

}  // namespace
}  // namespace strata::localization
