// SPDX-License-Identifier: Apache-2.0
/// What learning a patch map costs beside the recording it learns from, at once and online: days of
/// simulated scenarios with true poses. docs/benchmarks.md has the figures.
#include <algorithm>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <time.h>

#include "core/grid/counting_map.hpp"
#include "core/patch/online_learner.hpp"
#include "core/patch/patch_learner.hpp"
#include "tools/simulate/simulation.hpp"

namespace strata {
namespace {

struct Recording {
  std::vector<PosedScan> scans;
  ReflectionGrid base;  ///< of all of them
  double length_s = 0.0;
};

Recording recording_of(const std::string& scenario) {
  const simulate::Simulation simulation =
      simulate::simulate(simulate::load_scenario(STRATA_SCENARIO_DIR "/" + scenario + ".yaml"), 1);
  Recording recording;
  for (const simulate::SimulatedDay& day : simulation.days) {
    recording.length_s += (day.end - day.begin).seconds();
    for (const simulate::SimulatedScan& scan : day.scans) {
      recording.scans.push_back(
          {scan.observation.run, scan.observation.scan, scan.map_from_robot, {}});
    }
  }
  CountingMap counts;
  for (const PosedScan& scan : recording.scans) counts.add(scan);
  recording.base = counts.reflection();
  return recording;
}

double thread_s() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

constexpr const char* kScenarios[] = {"corridor_box", "office", "three_doors"};

void tell(benchmark::State& state, const Recording& recording, double work_s) {
  state.SetLabel(kScenarios[state.range(0)]);
  state.counters["scans"] = static_cast<double>(recording.scans.size());
  state.counters["recording_s"] = recording.length_s;
  state.counters["percent_of_recording"] = 100.0 * work_s / recording.length_s;
}

void learn_at_once(benchmark::State& state) {
  const Recording recording = recording_of(kScenarios[state.range(0)]);
  double work_s = 0.0;
  for (auto _ : state) {
    const double begin_s = thread_s();
    patch::PatchLearner learner({}, 1);
    for (const PosedScan& scan : recording.scans) learner.add(scan);
    benchmark::DoNotOptimize(learner.finish(recording.base));
    work_s = thread_s() - begin_s;
  }
  tell(state, recording, work_s);
}
BENCHMARK(learn_at_once)->DenseRange(0, 2)->Iterations(1)->Unit(benchmark::kMillisecond);

void learn_online(benchmark::State& state) {
  const Recording recording = recording_of(kScenarios[state.range(0)]);
  double work_s = 0.0;
  double longest_s = 0.0;
  for (auto _ : state) {
    patch::OnlinePatchLearner learner({}, {}, recording.base, 1);
    for (const PosedScan& scan : recording.scans) {
      const double begin_s = thread_s();
      const bool changed = learner.add(scan);
      if (changed) benchmark::DoNotOptimize(learner.map());
      const double scan_s = thread_s() - begin_s;
      work_s += scan_s;
      longest_s = std::max(longest_s, scan_s);
    }
  }
  tell(state, recording, work_s);
  state.counters["longest_scan_ms"] = 1e3 * longest_s;
}
BENCHMARK(learn_online)->DenseRange(0, 2)->Iterations(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace strata
