// SPDX-License-Identifier: Apache-2.0
/// Particles along the drive of the peers' scenario.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

#include "core/base/parallel.hpp"
#include "core/localization/particle_set.hpp"
#include "core/localization/sensor_model.hpp"
#include "core/random/stream.hpp"
#include "tests/bench/peers_scenario.hpp"

namespace strata::bench {

/// 500 particles about the true pose of each tenth scan.
inline std::vector<localization::ParticleSet> clouds() {
  RandomStream random(5, StreamId::kTest);
  std::vector<localization::ParticleSet> sets;
  for (std::size_t n = 0; n < peers_scenario().truth.size(); n += 10) {
    localization::ParticleSet set;
    set.resize(500);
    const Pose2& truth = peers_scenario().truth[n];
    for (std::size_t i = 0; i < set.size(); ++i) {
      set.set_pose(i, {truth.x + 0.1 * random.normal(), truth.y + 0.1 * random.normal(),
                       truth.theta + 0.03 * random.normal()});
    }
    localization::set_uniform_weights(set);
    sets.push_back(std::move(set));
  }
  return sets;
}

/// Weighs all clouds; returns how many beams and particles that were.
inline double weigh(const localization::SensorModel& model,
                    std::vector<localization::ParticleSet>& sets) {
  std::vector<double> log(500);
  WorkerPool pool(1);
  double pairs = 0.0;
  for (std::size_t n = 0; n < sets.size(); ++n) {
    const Scan& scan = peers_scenario().observations[10 * n].scan;
    pairs += 500.0 * static_cast<double>(model.log_likelihoods(scan, {1.0}, sets[n], log, pool));
    benchmark::DoNotOptimize(log.data());
  }
  return pairs;
}

}  // namespace strata::bench
