// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/verdict_worlds.hpp"

#include <utility>

#include "tools/laboratory/experiments/simulated_maps.hpp"
#include "tools/laboratory/experiments/wean.hpp"
#include "tools/pipeline/learn.hpp"
#include "tools/simulate/random_office.hpp"

namespace strata::experiments {
namespace {

constexpr double kLearnedShare = 0.6;

}  // namespace

VerdictWorld world_of_log(const std::string& log, const std::string& poses) {
  pipeline::RunsInput input;
  input.logs = {log};
  input.poses = {poses};
  const pipeline::Runs runs = pipeline::read_runs(input, nullptr);
  const auto learned =
      static_cast<std::ptrdiff_t>(kLearnedShare * static_cast<double>(runs.observations.size()));
  const pipeline::LearnParts parts{.patch = true, .timescale = false};
  const pipeline::LearnResult result =
      pipeline::learn({runs.observations.begin(), runs.observations.begin() + learned},
                      {runs.poses.begin(), runs.poses.begin() + learned},
                      pipeline::learn_at_given_poses(), parts, 1, 2, nullptr);
  return {std::filesystem::path(log).filename().string(),
          pipeline::maps_of(result, {}),
          {runs.observations.begin() + learned, runs.observations.end()},
          {runs.poses.begin() + learned, runs.poses.end()}};
}

VerdictWorld world_of_scans(const std::string& name, const simulate::Simulation& simulation,
                            const std::vector<PosedScan>& scans) {
  const StaticMaps maps = static_maps(scans);
  VerdictWorld world;
  world.name = name;
  world.maps.occupancy = maps.occupancy;
  world.maps.filtered = maps.filtered;
  world.maps.patches = learn_patches(scans, maps.filtered);
  for (const simulate::SimulatedScan& scan : simulation.days.back().scans) {
    world.observations.push_back(scan.observation);
    world.truths.emplace_back(scan.map_from_robot);
  }
  return world;
}

VerdictWorld world_of_scenario(const std::string& name, const simulate::ScenarioConfig& scenario,
                               std::uint64_t seed) {
  const simulate::Simulation simulation = simulate::simulate(scenario, seed);
  return world_of_scans(name, simulation,
                        noisy_scans(simulation, kGoodPoses, seed, 1, scenario.days - 1));
}

VerdictWorld world_of_office(std::uint64_t office) {
  constexpr std::uint64_t kSeeds = 100;
  return world_of_scenario("office " + std::to_string(office),
                           simulate::random_office(office, {4, true, 2}), kSeeds + office);
}

std::vector<VerdictWorld> worlds_of_runs(const std::filesystem::path& folder) {
  const WeanRuns wean = read_wean_runs(folder, 2);
  std::vector<VerdictWorld> worlds;
  for (int held_out = 0; held_out < 3; ++held_out) {
    WeanMaps learned =
        learn_wean_maps(wean, {held_out == 0 ? 1 : 0, held_out == 2 ? 1 : 2}, true, 2);
    VerdictWorld world;
    world.name = "run " + std::to_string(held_out + 1) + " held out";
    world.maps = std::move(learned.maps);
    for (std::size_t i = 0; i < wean.runs.observations.size(); ++i) {
      if (wean.runs.observations[i].run != held_out) continue;
      world.observations.push_back(wean.runs.observations[i]);
      world.truths.emplace_back();
      if (wean.common[i]) world.truths.back() = learned.map_from_common * *wean.common[i];
    }
    worlds.push_back(std::move(world));
  }
  return worlds;
}

}  // namespace strata::experiments
