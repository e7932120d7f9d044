// SPDX-License-Identifier: Apache-2.0
/// Learns a patch map from posed scans [stachniss2005patch; stachniss2003chapter section 1.3]
/// (docs/theory/patch_maps.md): contradictory cells, sub-maps, sequences, configurations.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/base/parallel.hpp"
#include "core/base/progress.hpp"
#include "core/patch/patch_learner_config.hpp"
#include "core/patch/patch_map.hpp"
#include "core/patch/region_growing.hpp"
#include "core/patch/sequences.hpp"
#include "core/scan/scan.hpp"

namespace strata::patch {

/// Collects scans and learns from all of them at once. Scans must come ordered by run, then time.
/// The result does not depend on the number of threads. Not thread-safe.
class PatchLearner {
 public:
  /// Throws ConfigError. threads: as WorkerPool.
  explicit PatchLearner(const PatchLearnerConfig& config, int threads = 1);

  /// Keeps the scan (about 4 bytes a beam; its static probabilities are not needed). A scan with a
  /// pose that is not finite is left out.
  void add(PosedScan scan);
  [[nodiscard]] std::size_t size() const { return scans_.size(); }

  /// The patch map over the lattice of `filtered`, which becomes its base, bit for bit. Without
  /// change there are no sub-maps. May be called again after more scans. Throws Cancelled.
  /// O(beams x cells a beam crosses + p^2 log p for p regions of change).
  [[nodiscard]] PatchMap finish(const ReflectionGrid& filtered, Progress* progress = nullptr);

 private:
  [[nodiscard]] Submap learn_submap(const Region& region, std::span<const Sequence> sequences,
                                    const ReflectionGrid& filtered) const;

  PatchLearnerConfig config_;
  WorkerPool pool_;
  std::vector<PosedScan> scans_;
};

}  // namespace strata::patch
