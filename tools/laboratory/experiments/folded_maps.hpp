// SPDX-License-Identifier: Apache-2.0
/// Whether a map that SLAM has folded says so, in buildings in which SLAM is hard.
#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/pose2.hpp"
#include "core/slam/slam.hpp"
#include "tools/laboratory/experiments/seed_reports.hpp"
#include "tools/shards/units.hpp"
#include "tools/simulate/scenario.hpp"

namespace strata::experiments {

/// How far from each other scans of one place were put.
struct Revisits {
  double pairs = 0.0;  ///< scans within 2 m of each other in truth, with 10 m of way between them
  double wrong = 0.0;  ///< of those, put more than 0.5 m wrong relative to each other
  double worst_m = 0.0;
  /// 1% of the pairs are wrong: walls lie beside themselves.
  [[nodiscard]] bool is_folded() const { return wrong > 0.0 && wrong >= 0.01 * pairs; }
};
/// Poses of the same scans of one run. O(scans squared / 25): every fifth scan is asked.
[[nodiscard]] Revisits judge_revisits(const std::vector<Pose2>& found,
                                      const std::vector<Pose2>& truth);

/// What SLAM made of one building. Numbers only: shards keep it.
struct FoldedMap {
  double error_m = 0.0;           ///< mean distance from the truth after one rigid alignment
  double odometry_error_m = 0.0;  ///< the same of odometry
  double contradicting = 0.0;     ///< pairs of slam::Consistency
  double compared = 0.0;
  double is_consistent = 0.0;  ///< 0 or 1
  Revisits revisits;
};
[[nodiscard]] FoldedMap map_building(const simulate::ScenarioConfig& building, std::uint64_t seed,
                                     const slam::SlamConfig& config = {});
/// Scan matching alone: loops stay open.
[[nodiscard]] slam::SlamConfig without_closures();

/// Prints a line for each kind of building, by SLAM and by scan matching alone, and for each that
/// was folded or is held to be.
void report_folded_maps(const Seeds& seeds, shards::Units& units);

}  // namespace strata::experiments
