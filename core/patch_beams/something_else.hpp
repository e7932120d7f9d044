// SPDX-License-Identifier: Apache-2.0
/// What a scan says if none of the configurations that were seen is there
/// (docs/theory/patch_localization.md, "Something else").
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/localization/patch_states.hpp"
#include "core/patch_beams/submap_ratios.hpp"

namespace strata::patch_beams {

/// Working memory of explain(). Allocates nothing once warm.
class SomethingElse {
 public:
  /// Something else in a sub-map explains a scan nearly as well as the best of its configurations
  /// does at the poses that are likely with it, and at all poses alike: it may stand anywhere. Less
  /// than nothing where no configuration does. Adds that to its row of each sub-map that expects it
  /// and that any beam met, for all particles. weight, log_likelihood: of all particles; ratios: of
  /// each chunk of `chunk_size` of them. O(particles x configurations of the sub-maps that beams
  /// met).
  void explain(const localization::PatchStates& layout, double tempering,
               std::span<const double> weight, std::span<const double> log_likelihood,
               std::size_t chunk_size, std::span<SubmapRatios> ratios);

 private:
  [[nodiscard]] bool find_gains(std::size_t submap, double tempering,
                                std::span<const double> log_likelihood, std::size_t chunk_size,
                                std::span<SubmapRatios> ratios);
  [[nodiscard]] double likely_gain(std::span<const double> weight);

  std::vector<double> gain_;   // of each particle: the best configuration over nothing there
  std::vector<double> total_;  // its log-likelihood with that
};

}  // namespace strata::patch_beams
