// SPDX-License-Identifier: Apache-2.0
/// The scenario `empty_room`, simulated: a run a day, with the truth.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "tools/pipeline/runs_input.hpp"
#include "tools/simulate/simulation.hpp"

namespace strata::pipeline::test_room {

/// truths: map_from_robot of every scan, in the frame of the walls; poses: none.
inline Runs simulate_runs(std::uint64_t seed, int days) {
  simulate::ScenarioConfig scenario =
      simulate::load_scenario(std::string(STRATA_SCENARIO_DIR) + "/empty_room.yaml");
  scenario.days = days;
  // The scenario's 61 beams are 4.4 degrees apart and a timescale node has bins of one degree: in a
  // drive of some seconds most of them would stay empty.
  scenario.laser.beams = 181;
  Runs runs;
  for (const simulate::SimulatedDay& day : simulate::simulate(scenario, seed).days) {
    for (const simulate::SimulatedScan& scan : day.scans) {
      runs.observations.push_back(scan.observation);
      runs.truths.emplace_back(scan.map_from_robot);
      runs.poses.emplace_back(std::nullopt);
    }
  }
  return runs;
}

/// The rigid motion from the truth's frame to the one of these scans, the runs' first.
inline Pose2 map_from_truth(const Runs& runs, const std::vector<PosedScan>& scans) {
  std::vector<Pose2> truth;
  std::vector<Pose2> map;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    truth.push_back(*runs.truths[i]);
    map.push_back(scans[i].map_from_robot);
  }
  return align(truth, map);
}

/// Runs whose truths are taken for their poses.
inline Runs simulate_located_runs(std::uint64_t seed, int days) {
  Runs runs = simulate_runs(seed, days);
  runs.poses = runs.truths;
  return runs;
}

}  // namespace strata::pipeline::test_room
