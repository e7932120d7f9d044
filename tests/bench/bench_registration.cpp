// SPDX-License-Identifier: Apache-2.0
/// Scan-to-map matching in the scenario of the peers; docs/benchmarks.md has the figures.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <deque>
#include <vector>

#include <benchmark/benchmark.h>

#include "core/registration/scan_matcher.hpp"
#include "core/scan/endpoints.hpp"
#include "core/tracking/surface_map.hpp"
#include "tests/bench/peers_scenario.hpp"

namespace strata {
namespace {

constexpr std::size_t kMapScans = 20;
constexpr std::size_t kEvery = 5;
constexpr double kMaxRange_m = 30.0;

/// One scan with the map of the 20 before it, at their true poses, and odometry's guess.
struct Task {
  slam::SurfaceMap map;
  Endpoints endpoints;
  Pose2 guess;
  Pose2 truth;
};

/// A deque: maps are large, and stay where they are.
std::deque<Task> tasks(std::size_t beams) {
  std::deque<Task> all;
  const bench::PeersScenario& scenario = bench::peers_scenario();
  for (std::size_t t = kMapScans; t < scenario.observations.size(); t += kEvery) {
    const Pose2 step = between(scenario.observations[t - 1].odom_from_robot,
                               scenario.observations[t].odom_from_robot);
    const Endpoints hits = endpoints_in_robot(scenario.observations[t].scan);
    all.push_back({slam::SurfaceMap(scenario.map.resolution_m(), {}),
                   subsample(hits, beams == 0 ? hits.size() : beams), scenario.truth[t - 1] * step,
                   scenario.truth[t]});
    for (std::size_t k = t - kMapScans; k < t; ++k) {
      const Scan& scan = scenario.observations[k].scan;
      all.back().map.add(scan, scenario.truth[k] * scan.robot_from_laser, {}, kMaxRange_m);
    }
    all.back().map.forget_counts();
  }
  return all;
}

/// Arguments: beams, 0 for all; levels from coarse to fine.
void match_scan(benchmark::State& state) {
  const std::deque<Task> all = tasks(static_cast<std::size_t>(state.range(0)));
  if (all.empty()) {
    state.SkipWithError("no peers_scenario in STRATA_DATA_DIR");
    return;
  }
  registration::MatchConfig config;
  config.levels = static_cast<int>(state.range(1));
  std::size_t next = 0;
  for (auto _ : state) {
    const Task& task = all[next++ % all.size()];
    benchmark::DoNotOptimize(
        registration::match(task.endpoints, {}, task.map.field(), task.guess, nullptr, config));
  }
  std::vector<double> errors_m;
  double turn_rad = 0.0;
  for (const Task& task : all) {
    const registration::MatchResult result =
        registration::match(task.endpoints, {}, task.map.field(), task.guess, nullptr, config);
    errors_m.push_back(translation_distance(result.pose, task.truth));
    turn_rad += std::abs(between(result.pose, task.truth).theta) / static_cast<double>(all.size());
  }
  double mean_m = 0.0;
  for (const double error_m : errors_m) mean_m += error_m / static_cast<double>(errors_m.size());
  std::sort(errors_m.begin(), errors_m.end());
  state.counters["mean_error_mm"] = 1000.0 * mean_m;
  state.counters["median_error_mm"] = 1000.0 * errors_m[errors_m.size() / 2];
  state.counters["mean_error_mrad"] = 1000.0 * turn_rad;
}
BENCHMARK(match_scan)->ArgsProduct({{0, 180}, {1, 2, 3}})->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace strata
