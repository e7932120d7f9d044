// SPDX-License-Identifier: Apache-2.0
/// Odds of topologies over many simulated buildings: `strata-experiments topologies`.
#pragma once

#include <filesystem>

#include "tools/laboratory/experiments/seed_reports.hpp"
#include "tools/laboratory/experiments/topology_trial.hpp"
#include "tools/shards/units.hpp"
#include "tools/simulate/scenario.hpp"

namespace strata::experiments {

/// Odometry that is 5 to 20% off, by the seed.
void draw_odometry_error(std::uint64_t seed, simulate::RobotConfig& robot);

/// Three buildings a seed: corridors whose crossings look alike, a random office, a random floor.
/// Prints for each kind what the odds were worth, and writes reliability diagrams into the folder
/// (report.html).
void report_topologies(const Seeds& seeds, const std::filesystem::path& folder,
                       shards::Units& units);

}  // namespace strata::experiments
