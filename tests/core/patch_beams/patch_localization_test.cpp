// SPDX-License-Identifier: Apache-2.0
// The corridor with a box of docs/theory/patch_localization.md, "Test worlds".
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "core/localization/localizer.hpp"
#include "core/patch_beams/patch_beam_model.hpp"
#include "tests/core/localization/box_world.hpp"

namespace strata::patch_beams {
namespace {

using localization::LocalizationResult;
using localization::Localizer;
using localization::LocalizerConfig;
using localization::make_grid_beam_model;
using localization::ParticleSet;
using localization::PatchMemory;
using localization::SensorModel;

using test::Box;
using test::BoxWorld;
using test::Drive;

const CellRect kRect{{0, 0}, {800, 60}};  // 40 m x 3 m

BoxWorld corridor() {
  // Closed at the left end and with a niche, so that the start is well localized; plain from 8 m
  // on.
  return {{0.0, 0.0, 40.0, 0.4}, {0.0, 2.6, 40.0, 3.0}, {0.0, 0.0, 0.4, 3.0}, {4.0, 0.4, 4.6, 1.0}};
}
Box box_at(int place) {
  const double x = 19.0 + 2.0 * place;
  return {x, 0.4, x + 0.5, 1.0};
}

std::shared_ptr<patch::PatchMap> corridor_map() {
  auto map = std::make_shared<patch::PatchMap>();
  map->base = test::rasterize(corridor(), 0.05, kRect);
  patch::Submap submap;
  submap.rect = {{370, 0}, {490, 60}};  // x in [18.5, 24.5)
  for (int place = 0; place < 3; ++place) {
    BoxWorld world = corridor();
    world.push_back(box_at(place));
    patch::Configuration configuration;
    configuration.reflection = test::rasterize(world, 0.05, kRect).cropped(submap.rect);
    configuration.prior = 1.0 / 3.0;
    submap.configurations.push_back(configuration);
  }
  map->submaps.push_back(submap);
  return map;
}

struct Outcome {
  double error_m = 0.0;  // mean over the part at the box
  double p_true = 0.0;   // before leaving the sub-map
};

Outcome run(const std::shared_ptr<const SensorModel>& model, int place, std::uint64_t seed) {
  BoxWorld world = corridor();
  world.push_back(box_at(place));
  Drive drive({2.0, 1.8, 0.0}, 100 + seed);
  LocalizerConfig config;
  config.particles = 300;
  config.adaptive = false;
  config.recovery.inject = false;
  Localizer localizer(config, model, seed, 2);
  localizer.initialize({drive.truth(), Eigen::Vector3d(0.01, 0.01, 0.001).asDiagonal()});
  Outcome outcome;
  int scans = 0;
  for (int n = 0; n < 220; ++n) {
    // There, and back and forth beside the box.
    const bool is_there = drive.truth().x > 23.0;
    drive.step({n < 160 && !is_there ? 0.15 : -0.1, 0.0, 0.0});
    const LocalizationResult result = localizer.update(drive.look(world, 4.0, 36));
    if (drive.truth().x > 20.0) {
      outcome.error_m += weighted_error(localizer.particles(), drive.truth());
      ++scans;
    }
    if (!result.submaps.empty() && result.submaps[0].mass > 0.99) {
      outcome.p_true = result.submaps[0].probability[static_cast<std::size_t>(place)];
    }
  }
  outcome.error_m /= scans;
  return outcome;
}

TEST(PatchLocalization, BeatsTheFilteredMapAtTheBox) {
  const auto map = corridor_map();
  const auto filtered = make_grid_beam_model(map->base);
  double filtered_error = 0.0;
  for (int place = 0; place < 3; ++place) {
    filtered_error += run(filtered, place, static_cast<std::uint64_t>(place) + 1).error_m / 3.0;
  }
  RecordProperty("error_m_filtered", std::to_string(filtered_error));
  for (const PatchMemory memory :
       {PatchMemory::kNone, PatchMemory::kShared, PatchMemory::kPerParticle}) {
    PatchBeamModelConfig config;
    config.states.memory = memory;
    const auto model = std::make_shared<PatchBeamModel>(map, config);
    double error = 0.0;
    double p_true = 1.0;
    for (int place = 0; place < 3; ++place) {
      const Outcome outcome = run(model, place, static_cast<std::uint64_t>(place) + 1);
      error += outcome.error_m / 3.0;
      p_true = std::min(p_true, outcome.p_true);
    }
    RecordProperty(std::string("error_m_") + enum_name(memory), std::to_string(error));
    EXPECT_LE(error, filtered_error / 3.0) << enum_name(memory);
    EXPECT_GT(p_true, 0.9) << enum_name(memory);
  }
}

TEST(PatchLocalization, IsBitIdenticalAtOneTwoAndEightThreads) {
  const auto model = std::make_shared<PatchBeamModel>(corridor_map());
  BoxWorld world = corridor();
  world.push_back(box_at(1));
  std::vector<ParticleSet> sets;
  for (const int threads : {1, 2, 8}) {
    Drive drive({18.0, 1.8, 0.0}, 9);
    Localizer localizer({}, model, 4, threads);
    localizer.initialize({drive.truth(), Eigen::Vector3d(0.04, 0.04, 0.01).asDiagonal()});
    for (int n = 0; n < 15; ++n) {
      drive.step({0.15, 0.0, 0.0});
      localizer.update(drive.look(world, 4.0, 36));
    }
    sets.push_back(localizer.particles());
  }
  for (std::size_t t = 1; t < sets.size(); ++t) {
    EXPECT_EQ(sets[t].x_m, sets[0].x_m);
    EXPECT_EQ(sets[t].weight, sets[0].weight);
    EXPECT_EQ(sets[t].beliefs, sets[0].beliefs);
  }
}

}  // namespace
}  // namespace strata::patch_beams
