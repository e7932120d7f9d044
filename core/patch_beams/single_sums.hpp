// SPDX-License-Identifier: Apache-2.0
/// What the beams of SingleBeams say, summed up for each box and particle: a row of particles at a
/// time, with the widest SIMD that the machine has.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/patch_beams/single_beams.hpp"
#include "core/rays/scan_mixture.hpp"

namespace strata::patch_beams {

/// Working memory of take(). Allocates nothing once warm.
class SingleSums {
 public:
  /// A share of those that are not mixed.
  static constexpr double kApart = -1.0;

  /// Sums over the beams of a bundle that met a box: of ln p if the cells are there, and if they
  /// are not, each less `mixed`; of ln p of the mixture, or if the cells are not there where
  /// nothing is mixed; and how many. Columns of one entry a box and bundle; `near` and `far` only
  /// where both are wanted.
  struct Columns {
    double* near = nullptr;
    double* far = nullptr;
    double* mixed = nullptr;
    double* beams = nullptr;
    double* near_power = nullptr;  ///< working memory: of 2, beside `near`
    double* mixed_power = nullptr;
    static constexpr std::size_t kCount = 6;
  };

  /// Takes all of `beams` out of logs[beam x bundles + bundle], which become 0, into sums that are
  /// valid until the next call: with probability share[box x bundles + bundle] such a beam ends at
  /// the cell that it met, else where logs says; or that is kept apart, with kApart. with_both: the
  /// columns `near` and `far` are wanted. Every SIMD target gives the same bits.
  [[nodiscard]] Columns take(const SingleBeams& beams, const rays::ScanMixture& mixture,
                             std::size_t bundles, std::span<const double> share, bool with_both,
                             double* logs);

 private:
  std::vector<double> near_;  // likelihoods
  std::vector<double> columns_;
};

}  // namespace strata::patch_beams
