// SPDX-License-Identifier: Apache-2.0
/// The beam mixture for all beams of a scan at once, with the widest SIMD that the machine has.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/rays/beam_mixture.hpp"
#include "core/rays/ray_boxes.hpp"
#include "core/rays/scan_beams.hpp"

namespace strata::rays {

/// A mixture with what depends on the measured ranges alone worked out once.
class ScanMixture {
 public:
  /// Keeps memory between scans.
  void prepare(const BeamMixture& mixture, const ScanBeams& beams);

  [[nodiscard]] const BeamMixture& mixture() const { return *mixture_; }
  [[nodiscard]] std::size_t size() const { return range_m_.size(); }

  /// log_likelihood[k] = ln mixture.likelihood(beam begin + k, expected_m[k]) for k < count, and no
  /// less than ln 1e-300, where weights of 0 make a beam impossible; any expected range, +infinity
  /// for none. Every SIMD target gives the same bits, within 1e-7 of those of BeamMixture. Requires
  /// begin + count <= size().
  void log_likelihoods(std::size_t begin, std::size_t count, const double* expected_m,
                       double* log_likelihood) const;

  /// The same for any beams: log_likelihood[k] for beam[k], whole numbers below size().
  void log_likelihoods_of(const double* beam, std::size_t count, const double* expected_m,
                          double* log_likelihood) const;

  /// All beams of several bundles: log_likelihood[b bundles + n] for beam b and expected_m[b
  /// bundles + n]. Requires a multiple of BeamBundles::kVector bundles.
  void log_likelihoods_of_bundles(std::size_t bundles, const double* expected_m,
                                  double* log_likelihood) const;

  /// One beam a row of BeamBundles::kVector bundles: the likelihoods themselves, no less than
  /// 1e-300, where anything is expected. Where nothing is, any number.
  void likelihoods_of_rows(std::span<const SingleRow> rows, const double* expected_m,
                           double* likelihood) const;

  /// What the kernel reads: constants, and one entry a beam.
  struct Terms {
    const double* range_m = nullptr;
    const double* short_m = nullptr;   ///< w_short l e^(-l z) [1/m]; -1: nothing returned
    const double* log_none = nullptr;  ///< when nothing is expected
    double missed = 0.0;               ///< no return where an obstacle is expected
    double log_missed = 0.0;
    double random = 0.0;
    double log_random = 0.0;
    double hit_peak = 0.0;
    double half_inverse = 0.0;
    double most_steep = 0.0;  ///< e^- this and less of the peak is nothing beside `random`
    double rate_per_m = 0.0;
    double r_max_m = 0.0;
    double margin_m = 0.0;   ///< nearer to either end the Gaussian is cut there
    double nearest_m = 0.0;  ///< and nearer than this left to BeamMixture
    double per_stddev = 0.0;
    static constexpr int kSteps = 32;  ///< a standard deviation
    static constexpr int kEntries = 6 * kSteps + 2;
    const double* mass = nullptr;   ///< mass of a standard normal below i / kSteps
    const double* slope = nullptr;  ///< its density there over kSteps
  };

 private:
  std::optional<BeamMixture> mixture_;
  Terms terms_;  // without the pointers
  std::vector<double> range_m_;
  std::vector<double> short_m_;
  std::vector<double> log_none_;
};

}  // namespace strata::rays
