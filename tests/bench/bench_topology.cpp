// SPDX-License-Identifier: Apache-2.0
/// Topologies: one landmark update, in buildings of many landmarks that look alike.
#include <algorithm>
#include <cstdint>
#include <ctime>
#include <vector>

#include <benchmark/benchmark.h>

#include "core/topology/topology_filter.hpp"
#include "tests/core/topology/junction_world.hpp"

namespace strata::topology {
namespace {

/// CPU time of every update of a drive on one thread; the counters are of the last updates, where
/// the topologies are largest: median and largest time, and at the end the truth's probability and
/// the likeliest topology's landmarks.
void time_updates(benchmark::State& state, const std::vector<test_world::Junction>& junctions,
                  const std::vector<int>& order, std::size_t last, const TopologyConfig& config) {
  const test_world::Drive drive = test_world::drive(junctions, order, config.odometry, 100);
  std::vector<double> times_ms;
  double truth = 0.0;
  double landmarks = 0.0;
  for (auto _ : state) {
    TopologyFilter filter(config, 1);
    for (std::size_t i = 0; i < drive.visits.size(); ++i) {
      LandmarkVisit visit = drive.visits[i];
      const std::clock_t begin = std::clock();
      filter.add(std::move(visit));
      const double time_ms = 1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
      if (i + last >= drive.visits.size()) times_ms.push_back(time_ms);
    }
    for (const Hypothesis& hypothesis : filter.posterior()) {
      if (landmarks == 0.0) {
        landmarks = 1.0 + *std::max_element(hypothesis.labels.begin(), hypothesis.labels.end());
      }
      if (hypothesis.labels == drive.truth) truth = hypothesis.probability;
    }
  }
  std::sort(times_ms.begin(), times_ms.end());
  state.counters["visits"] = static_cast<double>(drive.visits.size());
  state.counters["median_ms"] = times_ms[times_ms.size() / 2];
  state.counters["max_ms"] = times_ms.back();
  state.counters["truth"] = truth;
  state.counters["landmarks"] = landmarks;
}

void twenty_visits(benchmark::State& state) {
  TopologyConfig config;
  config.odometry.per_metre_m = 0.08;
  time_updates(state, test_world::fourteen_junctions(), test_world::twenty_visits(), 6, config);
}
BENCHMARK(twenty_visits)->Unit(benchmark::kMillisecond)->Iterations(3);

/// Landmarks in rows of ten, of six looks; visits 1.1 times as many. Rows look alike, and the
/// likeliest topologies lay them onto each other: they have far fewer landmarks than there are.
void many_landmarks(benchmark::State& state) {
  const auto landmarks = static_cast<int>(state.range(0));
  time_updates(state, test_world::rows_of_ten(landmarks), test_world::row_by_row(landmarks), 20,
               {});
}
BENCHMARK(many_landmarks)
    ->Arg(100)
    ->Arg(300)
    ->Arg(1000)
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1);

/// The same of which no two look alike: topologies are as large as the building.
void many_unlike_landmarks(benchmark::State& state) {
  const auto landmarks = static_cast<int>(state.range(0));
  time_updates(state, test_world::unlike_rows_of_ten(landmarks), test_world::row_by_row(landmarks),
               20, {});
}
BENCHMARK(many_unlike_landmarks)
    ->Arg(100)
    ->Arg(300)
    ->Arg(1000)
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1);

}  // namespace
}  // namespace strata::topology
