// SPDX-License-Identifier: Apache-2.0
/// Which beams hit static objects, and the map of what is static, by EM
/// [stachniss2003chapter, section 1.2] at given poses. The loop with poses is in core/slam.
#pragma once

#include <span>
#include <vector>

#include "core/base/parallel.hpp"
#include "core/base/progress.hpp"
#include "core/beam_filter/beam_model.hpp"
#include "core/beam_filter/config.hpp"
#include "core/grid/counting_map.hpp"
#include "core/grid/reflection_grid.hpp"
#include "core/scan/scan.hpp"

namespace strata::beam_filter {

/// E-step: e(t, n) = P(c = 1) of each beam of a scan, eq. (1.10). A beam without a hit (no return,
/// too close, invalid, cut at counting.max_range_m), and one that ends where the map is unknown,
/// tells nothing about its cause and gets the prior. With endpoint_tolerance the most reflecting
/// known cell of the 3 x 3 around the end decides. O(beams), one allocation.
[[nodiscard]] std::vector<float> label(const Scan& scan, const Pose2& map_from_laser,
                                       const ReflectionGrid& map, const BeamFilterConfig& config);

/// `label` for every scan, written to its static_probability. Returns the share of hits with
/// e < 0.5; 0 when there are no hits.
double label_all(std::span<PosedScan> scans, const ReflectionGrid& map,
                 const BeamFilterConfig& config, WorkerPool& pool, Progress* progress = nullptr);

/// The map of counts under EM; see `filter_counts`.
struct CountsResult {
  ReflectionGrid filtered;
  /// l = sum over beams of (1 - s) ln[(1 - p) + (2 p - 1) m_end] + sum_k l_k ln(1 - m_k), what EM
  /// raises at fixed poses (the paper's (1.7) depends on e and may fall), after each round [nats].
  /// m is kept kLogMargin from 0 and 1; unknown cells say nothing. The first entry is the map of
  /// round 0 (e = prior for all beams). In mode closed_form: round 0 and the limit.
  std::vector<double> log_likelihood;
  /// Q of eq. (1.7), (1.9) once a beam, to plot: docs/theory/beam_filter.md, "Objective".
  std::vector<double> expected_log_likelihood;
  int iterations = 0;
  /// closed_form: true. iterate: stopped because l no longer rose, not at max_iterations.
  bool converged = true;
};

/// EM on the counts of all beams, which is all that fixed poses leave of the data: every beam that
/// ends in one cell has the same e. With endpoint_tolerance cells are coupled through their
/// neighbours and l may fall; mode closed_form then takes the limit without the coupling, and one
/// EM step with it.
/// raw: counts with every beam taken as static. Throws ConfigError. O(cells x iterations).
[[nodiscard]] CountsResult filter_counts(const CountingMap& raw, const BeamFilterConfig& config);

struct FixedPoseResult {
  CountingMap raw;                     ///< every beam taken as static
  ReflectionGrid filtered;             ///< reflection probability of what is static; NaN unknown
  std::vector<double> log_likelihood;  ///< see CountsResult
  std::vector<double> expected_log_likelihood;  ///< see CountsResult
  double dynamic_fraction = 0.0;                ///< share of hits with e < 0.5
  int iterations = 0;
  bool converged = true;
};

/// The whole filter at the poses of the scans: count all, filter the counts, label every beam.
/// Overwrites static_probability of each scan; what it held before is not used. The same bits for
/// any number of threads. Throws ConfigError, Cancelled. O(beams x cells a beam crosses).
[[nodiscard]] FixedPoseResult filter_at_fixed_poses(std::span<PosedScan> scans,
                                                    const BeamFilterConfig& config,
                                                    WorkerPool& pool, Progress* progress = nullptr);

}  // namespace strata::beam_filter
