// SPDX-License-Identifier: Apache-2.0
/// How near refined poses come to the truth in maps that SLAM learned.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "tools/laboratory/experiments/seed_reports.hpp"
#include "tools/shards/units.hpp"
#include "tools/simulate/scenario.hpp"

namespace strata::experiments {

/// One day localized in the maps of the days before it. Means; distances of the scans whose pose
/// was refined.
struct RefinedOutcome {
  double scans = 0.0;
  double refined = 0.0;      ///< of those
  double particles_m = 0.0;  ///< weighted mean distance of the particles, as the papers have it
  double filtered_m = 0.0;   ///< of the particles' mean
  double refined_m = 0.0;
  double refined_p95_m = 0.0;  ///< 95th percentile
  double refined_rad = 0.0;
  /// Squared Mahalanobis distances of the truth: 3 where the covariance is right.
  double mahalanobis_squared = 0.0;
  double filtered_mahalanobis_squared = 0.0;
};

/// Learned by SLAM on all days but the last, whose poses `learn` aligns with the truth. A model a
/// row: filtered, patch.
[[nodiscard]] std::map<std::string, RefinedOutcome> refine_last_day(
    const simulate::ScenarioConfig& world, std::uint64_t seed);

/// Prints a line for each world and model: the office as it is, the office with a scanner of 1,440
/// beams and 1 cm noise, a plain corridor, and random offices.
void report_refined_poses(const std::string& scenarios, const Seeds& seeds, shards::Units& units);

}  // namespace strata::experiments
