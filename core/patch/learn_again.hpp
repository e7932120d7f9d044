// SPDX-License-Identifier: Apache-2.0
/// A patch map of scans whose poses have become known better since it was learned.
#pragma once

#include <cstddef>
#include <span>

#include "core/base/progress.hpp"
#include "core/grid/reflection_grid.hpp"
#include "core/patch/patch_learner_config.hpp"
#include "core/patch/patch_map.hpp"
#include "core/scan/scan.hpp"

namespace strata::patch {

struct LearnedAgain {
  PatchMap map;
  std::size_t stayed = 0;  ///< sub-maps that are as they were: most of their scans are not there
};

/// Learns from the scans at the poses that they have now, all at once, as PatchLearner does. Of the
/// patches that were known before only those sub-maps stay that rest mostly on scans that are not
/// among these, by the stamps of their sequences; nothing new takes a place that meets one of them.
/// The base is `filtered`, and, where a sub-map stays, what the base before knows besides. scans:
/// ordered by run, then time, poses in the frame of `filtered`. Patches of another resolution are
/// dropped. Throws Cancelled. Complexity: as PatchLearner::finish, and O(sequences x log scans).
[[nodiscard]] LearnedAgain learn_again(const PatchMap& before, std::span<const PosedScan> scans,
                                       const ReflectionGrid& filtered,
                                       const PatchLearnerConfig& config,
                                       Progress* progress = nullptr);

/// The newer static map, and the older one where that knows nothing, unless its cells are of
/// another size. O(cells).
[[nodiscard]] ReflectionGrid filled(const ReflectionGrid& newer, const ReflectionGrid& older);

}  // namespace strata::patch
