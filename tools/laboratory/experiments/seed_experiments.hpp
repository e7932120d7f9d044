// SPDX-License-Identifier: Apache-2.0
/// The experiments that are one simulated seed after the other, which several machines can share.
#pragma once

#include <string>

#include "tools/laboratory/experiments/seed_reports.hpp"
#include "tools/laboratory/experiments/simulated_maps.hpp"
#include "tools/shards/units.hpp"

namespace strata::experiments {

struct SeedOptions {
  std::string scenarios;  ///< folder of the scenario files
  Seeds seeds;
  PoseNoise noise;
  std::string out;  ///< folder of the files that some write
};

/// Runs the experiment and prints what it comes to; false for the name of none of these.
[[nodiscard]] bool run_seed_experiment(const std::string& name, const SeedOptions& options,
                                       shards::Units& units);

}  // namespace strata::experiments
