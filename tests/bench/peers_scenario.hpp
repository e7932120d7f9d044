// SPDX-License-Identifier: Apache-2.0
/// The scenario that other localizers were measured in: 500 x 500 cells of 0.05 m, 120 scans of 360
/// beams to 10 m with 5% outliers, noisy odometry, exact truth.
#pragma once

#include <vector>

#include "core/grid/reflection_grid.hpp"
#include "core/localization/localizer_config.hpp"
#include "core/scan/scan.hpp"

namespace strata::bench {

struct PeersScenario {
  ReflectionGrid map;
  std::vector<Pose2> truth;
  std::vector<Observation> observations;
  bool found = false;  ///< false: no peers_scenario in STRATA_DATA_DIR
};

/// Read once.
[[nodiscard]] const PeersScenario& peers_scenario();

/// Every scan weighed, always this many particles, resampling at every scan.
[[nodiscard]] localization::LocalizerConfig fixed_particles(int particles);

}  // namespace strata::bench
