// SPDX-License-Identifier: Apache-2.0
/// Sub-maps that follow the places of a topology instead of what sees each other, which
/// [stachniss2005patch] names as future work.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/progress.hpp"
#include "core/patch/patch_learner_config.hpp"
#include "core/patch/patch_map.hpp"
#include "core/scan/scan.hpp"
#include "core/slam/slam.hpp"
#include "core/topology/mapper_config.hpp"

namespace strata::pipeline {

/// Landmarks of the likeliest topology of all scans, one run after the other, at the poses that
/// they have: x and y in the map frame, in m, one after the other, by first visit. Empty when the
/// detector finds no landmark. scans: as SLAM leaves them, ordered by run, then time.
/// Deterministic for a seed at any number of threads. O(scans x beams), and one update of the
/// topology filter a landmark. Throws Cancelled.
[[nodiscard]] std::vector<double> topology_places(std::span<const PosedScan> scans,
                                                  const topology::TopologyMapperConfig& config,
                                                  std::uint64_t seed, int threads,
                                                  Progress* progress);

/// The patch map whose regions belong to the nearest of these places (as topology_places gives
/// them); without a place that of the configuration. Throws Cancelled.
[[nodiscard]] patch::PatchMap learn_place_patches(const slam::SlamResult& result,
                                                  const std::vector<double>& places,
                                                  const patch::PatchLearnerConfig& config,
                                                  int threads, Progress* progress);

}  // namespace strata::pipeline
