// SPDX-License-Identifier: Apache-2.0
/// Maps, and drives to localize in them, simulated and real.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "components/maps/maps_folder.hpp"
#include "core/scan/scan.hpp"
#include "tools/pipeline/learned_maps.hpp"
#include "tools/simulate/scenario.hpp"
#include "tools/simulate/simulation.hpp"

namespace strata::experiments {

/// Maps, and a drive to localize in them.
struct VerdictWorld {
  std::string name;
  maps::Maps maps;
  std::vector<Observation> observations;
  pipeline::Poses truths;  ///< one an observation
};

/// A log with poses: maps of its first 60%, and the rest of it.
[[nodiscard]] VerdictWorld world_of_log(const std::string& log, const std::string& poses);
/// Maps of scans of a simulation's days but the last, and that one.
[[nodiscard]] VerdictWorld world_of_scans(const std::string& name,
                                          const simulate::Simulation& simulation,
                                          const std::vector<PosedScan>& scans);
/// Three days of a random office, and its fourth.
[[nodiscard]] VerdictWorld world_of_office(std::uint64_t office);
/// The same of any scenario with several days: all but the last, and the last. The simulation of
/// `seed`, and the errors of the poses that it is mapped at.
[[nodiscard]] VerdictWorld world_of_scenario(const std::string& name,
                                             const simulate::ScenarioConfig& scenario,
                                             std::uint64_t seed);

/// The three runs of Wean Hall, each in maps of the others.
[[nodiscard]] std::vector<VerdictWorld> worlds_of_runs(const std::filesystem::path& folder);

}  // namespace strata::experiments
