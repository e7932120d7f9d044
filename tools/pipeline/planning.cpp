// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/planning.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/grid/counting_map.hpp"
#include "tools/statistics/statistics.hpp"

namespace strata::pipeline {
namespace {

constexpr double kRobotRadius_m = 0.25;
constexpr double kMinPathLength_m = 2.0;

bool is_blocked(const Path& path, const ReflectionGrid& found) {
  for (std::size_t i = 1; i < path.size(); ++i) {
    for (const double share : {0.0, 0.5}) {
      const Eigen::Vector2d point = path[i - 1] + share * (path[i] - path[i - 1]);
      if (found.get(found.cell_at(point)) >= kMostlyOccupied) return true;
    }
  }
  return false;
}

double variation(const std::vector<double>& lengths_m) {
  const double mean = statistics::mean(lengths_m);
  double squares = 0.0;
  for (const double length : lengths_m) squares += (length - mean) * (length - mean);
  return mean > 0.0 ? std::sqrt(squares / static_cast<double>(lengths_m.size())) / mean : 0.0;
}

/// The answers to one task.
struct Answers {
  std::optional<Path> last;
  bool is_blocked = false;
  std::vector<double> lengths_m;
  std::vector<double> steps_m;  ///< from a path to the next

  void add(const std::optional<Path>& path) {
    if (path) {
      lengths_m.push_back(length_m(*path));
      if (last) steps_m.push_back(pipeline::frechet_m(*last, *path));
    }
    last = path;
  }
};

}  // namespace

std::vector<PlanningTask> planning_tasks(const TestScans& test) {
  std::vector<Eigen::Vector2d> places;
  for (const auto& truth : test.truths) {
    if (truth) places.push_back(truth->translation());
  }
  std::vector<PlanningTask> tasks;
  for (std::size_t third = 0; third < 3 && !places.empty(); ++third) {
    const Eigen::Vector2d start = places[third * places.size() / 3];
    const auto goal =
        std::max_element(places.begin(), places.end(), [&](const auto& a, const auto& b) {
          return (a - start).squaredNorm() < (b - start).squaredNorm();
        });
    if ((*goal - start).norm() >= kMinPathLength_m) tasks.push_back({start, *goal});
  }
  return tasks;
}

ReflectionGrid map_of_drive(const TestScans& test, double resolution_m) {
  CountingMap map(resolution_m);
  for (std::size_t i = 0; i < test.observations.size(); ++i) {
    if (!test.truths[i]) continue;
    map.add({test.observations[i].run, test.observations[i].scan, *test.truths[i], {}});
  }
  return map.reflection();
}

PlanningScore judge_planning(const TestScans& test, const std::vector<PlanningTask>& tasks,
                             const ReflectionGrid& found, OnlinePredictor& predictor,
                             std::size_t times) {
  PlanningScore score;
  std::vector<Answers> answers(tasks.size());
  std::shared_ptr<const ReflectionGrid> planned_in;
  std::vector<std::optional<Path>> paths(tasks.size());
  const std::size_t every = std::max<std::size_t>(1, test.observations.size() / times);
  for (std::size_t i = 0; i < test.observations.size() && !tasks.empty(); ++i) {
    if (!test.truths[i]) continue;
    predictor.go_to(*test.truths[i], test.observations[i].scan.stamp);
    if (i % every == 0) {
      const std::shared_ptr<const ReflectionGrid> map = predictor.map();
      if (!map) return {};
      if (map != planned_in) {
        const PathPlanner planner(*map, kRobotRadius_m);
        for (std::size_t t = 0; t < tasks.size(); ++t) {
          paths[t] = planner.plan(tasks[t].start_m, tasks[t].goal_m);
          answers[t].is_blocked = paths[t] && is_blocked(*paths[t], found);
        }
        planned_in = map;
      }
      for (std::size_t t = 0; t < tasks.size(); ++t) {
        ++score.queries;
        score.without_path += paths[t] ? 0 : 1;
        score.blocked += answers[t].is_blocked ? 1 : 0;
        answers[t].add(paths[t]);
      }
    }
    predictor.learn(test.observations[i], *test.truths[i]);
  }
  std::vector<double> variations;
  std::vector<double> steps_m;
  for (const Answers& task : answers) {
    if (!task.lengths_m.empty()) variations.push_back(variation(task.lengths_m));
    steps_m.insert(steps_m.end(), task.steps_m.begin(), task.steps_m.end());
  }
  if (!variations.empty()) score.length_cv = statistics::mean(variations);
  if (!steps_m.empty()) score.frechet_m = statistics::mean(steps_m);
  return score;
}

}  // namespace strata::pipeline
