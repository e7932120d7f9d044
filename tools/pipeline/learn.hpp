// SPDX-License-Identifier: Apache-2.0
/// The direct path of learning: observations in, every map out, by calling core and memory.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "components/maps/earlier_runs.hpp"
#include "components/maps/learn_config.hpp"
#include "core/base/progress.hpp"
#include "core/patch/patch_map.hpp"
#include "core/scan/scan.hpp"
#include "core/slam/slam.hpp"
#include "memory/nodes/timescale_memory.hpp"

namespace strata::pipeline {

/// What to learn beyond the poses and the two grid maps, which everything else stands on.
struct LearnParts {
  bool patch = true;
  bool timescale = true;
};

struct LearnResult {
  slam::SlamResult slam;
  patch::PatchMap patches;  ///< empty, base map too, where they were not asked for
  /// Whose sub-maps follow the places of a topology, and those places (see topology_places); when
  /// a comparison asks for it.
  std::optional<patch::PatchMap> place_patches;
  std::vector<double> places;
  std::shared_ptr<memory::TimescaleMemory> timescale;
  std::size_t forgotten_scans = 0;  ///< of earlier runs, before anything was learned
};

/// Learns from one or several runs. observations: all runs, one after the other, in time order
/// within a run. given_poses: empty, or one an observation (nothing where no pose is known),
/// map_from_robot. earlier: runs learned before (or null), whose poses stay, whose map the new runs
/// are placed in, and whose timescale memory goes on, with its own settings; run ids must be
/// larger; what `config.history` lets go of is taken out of it first. Deterministic for a seed at
/// any number of threads. Throws Cancelled.
[[nodiscard]] LearnResult learn(const std::vector<Observation>& observations,
                                const std::vector<std::optional<Pose2>>& given_poses,
                                const maps::LearnConfig& config, const LearnParts& parts,
                                std::uint64_t seed, int threads, Progress* progress,
                                maps::EarlierRuns* earlier = nullptr);

}  // namespace strata::pipeline
