// SPDX-License-Identifier: Apache-2.0
/// What the state of sub-maps costs: localization in a patched map against the same in a plain one.
#include <memory>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

#include "core/localization/localizer.hpp"
#include "core/localization/range_provider_model.hpp"
#include "core/patch_beams/patch_beam_model.hpp"
#include "core/random/stream.hpp"
#include "tests/bench/peers_scenario.hpp"
#include "tests/bench/ratios.hpp"
#include "tests/bench/scenario_clouds.hpp"

namespace strata {
namespace {

using bench::clouds;
using bench::compare;
using bench::peers_scenario;
using bench::weigh;

/// The scenario's map with a sub-map of 4 m x 4 m and two configurations at every 30th pose.
std::shared_ptr<const patch::PatchMap> patched_map() {
  const auto& scenario = peers_scenario();
  auto map = std::make_shared<patch::PatchMap>();
  map->base = scenario.map;
  for (std::size_t n = 0; n < scenario.truth.size(); n += 30) {
    const Cell cell = scenario.map.cell_at(scenario.truth[n].translation());
    patch::Submap submap;
    submap.id = static_cast<int>(map->submaps.size());
    submap.rect =
        CellRect{cell, {cell.x + 1, cell.y + 1}}.inflated(40).intersected(scenario.map.rect());
    for (int k = 0; k < 2; ++k) {
      patch::Configuration configuration;
      configuration.reflection = scenario.map.cropped(submap.rect);
      configuration.prior = 0.5;
      const CellRect box =
          CellRect{{cell.x + 20, cell.y - 8}, {cell.x + 30, cell.y + 8}}.intersected(submap.rect);
      for (int y = box.min.y; y < box.max.y && k == 1; ++y) {
        for (int x = box.min.x; x < box.max.x; ++x) configuration.reflection.at({x, y}) = 1.0F;
      }
      submap.configurations.push_back(std::move(configuration));
    }
    // So that something else is expected there, too.
    for (const int k : {0, 0, 1}) {
      patch::SequenceInfo sequence;
      sequence.begin = Stamp::from_seconds(3600.0 * static_cast<double>(submap.sequences.size()));
      sequence.end = sequence.begin;
      sequence.membership = {k == 0 ? 1.0 : 0.0, k == 1 ? 1.0 : 0.0};
      submap.sequences.push_back(sequence);
    }
    map->submaps.push_back(std::move(submap));
  }
  return map;
}

/// The beam model in the patched map, against the same without: what the patch state costs.
/// Argument: PatchMemory.
void patch_state(benchmark::State& state) {
  const auto& scenario = peers_scenario();
  if (!scenario.found) return state.SkipWithError("no peers_scenario in STRATA_DATA_DIR");
  patch_beams::PatchBeamModelConfig config;
  config.states.memory = static_cast<localization::PatchMemory>(state.range(0));
  const patch_beams::PatchBeamModel model(patched_map(), config);
  const auto grid = localization::make_grid_beam_model(scenario.map);
  auto sets = clouds();
  auto patched = sets;
  RandomStream random(6, StreamId::kTest);
  for (localization::ParticleSet& set : patched) {
    model.patch_states()->prepare(set);
    for (std::size_t i = 0; i < set.size(); ++i) model.patch_states()->draw(set, i, random);
  }
  const double pairs = weigh(*grid, sets);
  compare(
      state, pairs, [&] { weigh(model, patched); }, [&] { weigh(*grid, sets); });
}
BENCHMARK(patch_state)->ArgName("memory")->DenseRange(0, 2);

/// The same for whole updates along the scenario. Arguments: PatchMemory, particles, beams.
void patch_update(benchmark::State& state) {
  const auto& scenario = peers_scenario();
  if (!scenario.found) return state.SkipWithError("no peers_scenario in STRATA_DATA_DIR");
  patch_beams::PatchBeamModelConfig config;
  config.states.memory = static_cast<localization::PatchMemory>(state.range(0));
  const auto particles = static_cast<std::size_t>(state.range(1));
  config.beam.beams.min_angle_rad = 6.283 / static_cast<double>(state.range(2));
  const localization::LocalizerConfig fixed = bench::fixed_particles(static_cast<int>(particles));
  localization::Localizer patched(
      fixed, std::make_shared<patch_beams::PatchBeamModel>(patched_map(), config), 1);
  localization::Localizer plain(fixed,
                                localization::make_grid_beam_model(scenario.map, config.beam), 1);
  bench::Ratios drives;
  for (auto _ : state) {
    for (localization::Localizer* localizer : {&patched, &plain}) {
      localizer->initialize({scenario.truth[0], Eigen::Vector3d(0.04, 0.04, 0.01).asDiagonal()});
    }
    drives.begin();
    // In turn, scan by scan: what else the machine does hits both.
    for (const Observation& observation : scenario.observations) {
      drives.add([&] { benchmark::DoNotOptimize(patched.update(observation)); },
                 [&] { benchmark::DoNotOptimize(plain.update(observation)); });
    }
  }
  const auto beams = static_cast<double>(
      rays::select_beams(scenario.observations[0].scan, config.beam.beams).size());
  drives.report(state, static_cast<double>(particles) * beams *
                           static_cast<double>(scenario.observations.size()));
}
BENCHMARK(patch_update)
    ->ArgNames({"memory", "particles", "beams"})
    ->ArgsProduct({{0, 1, 2}, {500, 1000, 2000, 10000}, {60, 72, 180, 360}})
    // A drive takes minutes here.
    ->ArgsProduct({{0, 1, 2}, {100000}, {60, 72, 180, 360}});

}  // namespace
}  // namespace strata
