// SPDX-License-Identifier: Apache-2.0
/// Is what stood there for 30 s learned? (docs/theory/evaluation.md, "False adaptation")
///
/// Nobody can order a recorded log to have someone stand still for 30 s and leave. So a round
/// obstacle is put into the recorded scans, at places the robot sees before and after; a model that
/// goes along with it is compared with the same model that never met it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "tools/pipeline/online_predictor.hpp"
#include "tools/pipeline/scan_prediction.hpp"

namespace strata::pipeline {

inline constexpr double kTransient_s = 30.0;

/// An obstacle that stood at a place of the map for kTransient_s.
struct Transient {
  std::size_t first_scan = 0;  ///< of the test part
  std::size_t last_scan = 0;
  Eigen::Vector2d center_m;
  double radius_m = 0.3;
  /// Scans after it left that look through its place, and their beams that do; at most ten.
  std::vector<std::pair<std::size_t, std::vector<std::uint32_t>>> views;
};

/// Places beside the robot's way, one after the other, at most `most` of them: 1.5 m off, in what
/// the laser sees as free, at least 0.8 m from where the robot will be while the obstacle is there,
/// in view for ten scans of that time and for three after it. Deterministic.
[[nodiscard]] std::vector<Transient> place_transients(const TestScans& test, double r_max_m,
                                                      std::size_t most = 10);

/// The scan as it would have been with the obstacle there. O(beams).
[[nodiscard]] Scan with_obstacle(const Scan& scan, const Pose2& map_from_robot,
                                 const Transient& transient);

/// Beams through the places of obstacles that have left.
struct FalseAdaptation {
  std::size_t right = 0;  ///< predicted within kBinTolerance_m by the model that never met them
  std::size_t wrong = 0;  ///< of those, not any more by the model that did
};

/// undisturbed, disturbed: two predictors of one model, which go along.
[[nodiscard]] FalseAdaptation follow_transients(const TestScans& test,
                                                const std::vector<Transient>& transients,
                                                double r_max_m, OnlinePredictor& undisturbed,
                                                OnlinePredictor& disturbed);

}  // namespace strata::pipeline
