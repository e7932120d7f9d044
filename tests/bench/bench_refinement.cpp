// SPDX-License-Identifier: Apache-2.0
/// A refined pose beside the filter's; docs/benchmarks.md has the figures.
#include <cstddef>
#include <vector>

#include <benchmark/benchmark.h>

#include "core/geometry/pose2_gaussian.hpp"
#include "core/refinement/pose_refiner.hpp"
#include "tests/core/refinement/surveyed_world.hpp"

namespace strata {
namespace {

/// Argument: beams of a scan. Time: one scan, whose filter is 3 cm and 0.01 rad off.
void refine_pose(benchmark::State& state) {
  const test::SurveyedWorld world =
      test::survey(test::scans_at(test::crooked_room(), test::places(1.0, 2.0, 7.0, 4.0, 0.5), 11));
  refinement::PoseRefiner refiner(world.map, world.surfaces, nullptr);
  RandomStream random(5, StreamId::kTest);
  std::vector<Scan> scans;
  std::vector<localization::LocalizationResult> results;
  for (int i = 0; i < 64; ++i) {
    const Pose2 truth{1.0 + 6.0 * random.uniform(), 1.5 + 3.0 * random.uniform(),
                      6.0 * random.uniform()};
    scans.push_back(test::make_scan(test::crooked_room(), truth, 12.0,
                                    static_cast<int>(state.range(0)), 0.01, random, 1.0));
    localization::LocalizationResult result;
    result.pose = {{truth.x + 0.02 * random.normal(), truth.y + 0.02 * random.normal(),
                    truth.theta + 0.01 * random.normal()},
                   pose_covariance(0.03, 0.01)};
    result.score = 0.95;
    results.push_back(result);
  }
  std::size_t next = 0;
  std::size_t refined = 0;
  for (auto _ : state) {
    const std::size_t i = next++ % scans.size();
    refined += refiner.refine(scans[i], results[i]) ? 1 : 0;
  }
  state.counters["refined"] = static_cast<double>(refined) / static_cast<double>(next);
}

BENCHMARK(refine_pose)
    ->ArgName("beams")
    ->Arg(181)
    ->Arg(360)
    ->Arg(1080)
    ->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace strata
