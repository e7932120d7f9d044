// SPDX-License-Identifier: Apache-2.0
/// Would a robot that plans in this map change its mind, or drive into what is there?
/// (docs/theory/evaluation.md, "Planning stability")
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/grid/reflection_grid.hpp"
#include "tools/pipeline/online_predictor.hpp"
#include "tools/pipeline/path_planner.hpp"
#include "tools/pipeline/scan_prediction.hpp"

namespace strata::pipeline {

/// From where to where, asked again and again during the drive.
struct PlanningTask {
  Eigen::Vector2d start_m;
  Eigen::Vector2d goal_m;
};
/// From where the drive was at its beginning, after a third and after two thirds, to the place of
/// the drive that lies furthest from there. Empty when the drive stays within 2 m.
[[nodiscard]] std::vector<PlanningTask> planning_tasks(const TestScans& test);

/// What the drive itself found, at the true poses: obstacles that at least half of the beams ended
/// in. Paths are checked against it.
[[nodiscard]] ReflectionGrid map_of_drive(const TestScans& test, double resolution_m);

struct PlanningScore {
  std::size_t queries = 0;
  std::size_t without_path = 0;
  std::size_t blocked = 0;  ///< paths that lead through what the drive found occupied
  /// Over the tasks, where there are paths: standard deviation over mean of their lengths, and
  /// the discrete Frechet distance between a path and the next one [m].
  std::optional<double> length_cv;
  std::optional<double> frechet_m;
};

/// Asks the predictor, which goes along, for a plan `times` times, evenly over the drive.
[[nodiscard]] PlanningScore judge_planning(const TestScans& test,
                                           const std::vector<PlanningTask>& tasks,
                                           const ReflectionGrid& found, OnlinePredictor& predictor,
                                           std::size_t times = 15);

}  // namespace strata::pipeline
