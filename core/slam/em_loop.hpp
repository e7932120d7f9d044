// SPDX-License-Identifier: Apache-2.0
/// The EM loop with poses: which beams are static, given poses; the poses, given the static beams.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/base/parallel.hpp"
#include "core/base/progress.hpp"
#include "core/beam_filter/config.hpp"
#include "core/grid/counting_map.hpp"
#include "core/grid/reflection_grid.hpp"
#include "core/scan/scan.hpp"
#include "core/slam/slam_config.hpp"

namespace strata::slam {

struct EmResult {
  CountingMap raw;
  ReflectionGrid filtered;
  std::vector<double> log_likelihood;
  int iterations = 0;
  double dynamic_fraction = 0.0;
};

/// After the incremental pass (docs/theory/slam.md, "The EM loop"): E-step labels for every beam,
/// every scan matched again to the map of static beams (M-step over poses), the map made anew in
/// closed form (M-step over the map), until the log-likelihood gains less than min_gain of itself
/// twice, falls by more than 1%, or max_iterations. The best iterate's poses and labels are left in
/// `scans`. The paper registers incrementally each round; here loops are closed already, each scan
/// is matched to the map of all, held near its pose by a prior. mapped[i]: scan i enters it (motion
/// gate); moves[i]: its pose may change. Same lengths. The same bits for any number of threads.
/// Throws Cancelled. O(iterations x scans x beams).
[[nodiscard]] EmResult run_em(std::span<PosedScan> scans, const std::vector<bool>& mapped,
                              const std::vector<bool>& moves, const EmConfig& config,
                              const TrackingConfig& tracking,
                              const beam_filter::BeamFilterConfig& filter, WorkerPool& pool,
                              Progress* progress);

}  // namespace strata::slam
