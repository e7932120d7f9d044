// SPDX-License-Identifier: Apache-2.0
/// Whether what a candidate learned anew agrees with what is active: a drive in another building,
/// or one that was put where it was not, is in its maps and harms nobody who drives elsewhere.
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "core/grid/reflection_grid.hpp"
#include "tools/site/gate.hpp"

namespace strata::site {

/// A run of the candidate that the active version does not know.
struct NewRun {
  int run = 0;
  std::size_t scans = 0;      ///< that the active map can judge
  double contradicted = 0.0;  ///< share of these, pipeline::FitState
  Period period;
};

/// Those with enough scans to be judged (pipeline::kFitWindow). Maps without scans have none.
/// filtered: the active version's. O(beams of both).
[[nodiscard]] std::vector<NewRun> judge_new_runs(const std::filesystem::path& candidate,
                                                 const std::filesystem::path& active,
                                                 const ReflectionGrid& filtered);

/// A check of each run. One that contradicts the active version by too much passes where a
/// recording of another drive, whose stamps are others, contradicts it about as much: the building
/// changed.
void check_new_runs(const std::vector<NewRun>& runs, const GateConfig& config, GateReport& report);

}  // namespace strata::site
