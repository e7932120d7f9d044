// SPDX-License-Identifier: Apache-2.0
/// Learns a patch map from posed scans [stachniss2005patch; stachniss2003chapter section 1.3; SPEC
/// B]: contradictory cells, sub-maps, observation sequences, configurations.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/base/parallel.hpp"
#include "core/base/progress.hpp"
#include "core/grid/counting_map.hpp"
#include "core/patch/contradiction.hpp"
#include "core/patch/model_selection.hpp"
#include "core/patch/patch_map.hpp"
#include "core/patch/region_growing.hpp"
#include "core/patch/sequences.hpp"
#include "core/patch/visits.hpp"
#include "core/scan/scan.hpp"

namespace strata::patch {

struct PatchLearnerConfig {
  CountingOptions counting;
  VisitConfig visits;
  ContradictionConfig contradiction;
  RegionConfig regions;
  SequenceConfig sequences;
  ModelSelectionConfig clustering;
  double prior = 0.9;
  double min_evidence = 0.5;
  bool keep_single_configuration = false;

  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.group("counting", c.counting, "how scans are counted");
    v.group("visits", c.visits, "what one visit is");
    v.group("contradiction", c.contradiction, "when visits contradict each other");
    v.group("regions", c.regions, "from contradictory cells to sub-maps");
    v.group("sequences", c.sequences, "which scans are one observation of a sub-map");
    v.group("clustering", c.clustering, "how many configurations, and which");
    v.field("prior", c.prior,
            {.doc = "P(a beam ends on something static), for the beam filter within a sequence",
             .unit = "1",
             .min = 0.5,
             .max = 1.0});
    v.field("min_evidence", c.min_evidence,
            {.doc = "cells with less evidence are unknown", .unit = "beams", .min = 1e-3});
    v.field("keep_single_configuration", c.keep_single_configuration,
            {.doc = "keep areas whose sequences all show one configuration; they say no more than "
                    "the static map"});
    v.require(c.prior > 0.5, "prior", "is 0.5, where every cell turns free",
              "choose a value above 0.5, such as 0.9");
  }
};

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
