// SPDX-License-Identifier: Apache-2.0
/// Error against bytes: every model learned again in less and less memory, and who is best when all
/// get the same (docs/theory/evaluation.md, "Equal memory").
///
/// A step halves the resolution of the grids, which quarters the bytes of occupancy, filtered and
/// patch maps. Of the timescale memory, which is some fifty times as large, it halves the angle
/// bins and the samples of each level and doubles the space between nodes: about a tenth.
/// Everything is learned anew from the same scans at the same poses; nothing is subsampled
/// afterwards.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/parallel.hpp"
#include "tools/pipeline/candidates.hpp"
#include "tools/pipeline/comparison.hpp"
#include "tools/pipeline/learned_maps.hpp"
#include "tools/pipeline/test_part.hpp"

namespace strata::pipeline {

/// Settings for smaller maps; step 0: those given.
[[nodiscard]] maps::LearnConfig with_less_memory(const maps::LearnConfig& config, int step);
/// What they are for a model, for people: "0.10 m cells", "180 bins, 2/10/25
/// samples, nodes 2 m apart".
[[nodiscard]] std::string memory_setting(const maps::MapModelDescriptor& model,
                                         const maps::LearnConfig& config);

/// A split whose maps and test parts are there already, at full memory.
struct FullMemory {
  const Split& split;
  const Learned& learned;
  const std::vector<TestPart>& parts;
};

/// Runs that all splits together take in smaller maps.
[[nodiscard]] std::size_t count_memory_runs(const Runs& runs, const CompareConfig& config,
                                            const CompareJob& job);

/// Learns the split again at each step, localizes in it with the first seeds, and adds the errors
/// to the curves of the results (one a model of the configuration; maps that were given, and peers,
/// stay as they are). The first point of a curve is the map at full memory, from the runs that are
/// there: results are of this split alone.
void add_memory_curves(const Runs& runs, const FullMemory& full, const CompareConfig& config,
                       const CompareJob& job, WorkerPool& pool, SharedProgress& progress,
                       std::vector<ModelResult>& results);

/// A budget, and the best that each model can do within it.
struct MemoryBudget {
  std::size_t bytes = 0;
  /// One a model of the comparison: its point with the most bytes that fits; null: none does.
  std::vector<const MemoryPoint*> points;
};
/// Budgets are the sizes of the models at full memory, the least first; sizes within a tenth of one
/// another count as one, the larger. Points into the comparison.
[[nodiscard]] std::vector<MemoryBudget> equal_memory(const Comparison& comparison);

}  // namespace strata::pipeline
