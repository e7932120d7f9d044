// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/scan_prediction.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/parallel.hpp"
#include "core/localization/scan_beams.hpp"
#include "tools/statistics/statistics.hpp"

namespace strata::pipeline {

ScanPrediction predict_scans(std::span<const Observation> observations,
                             std::span<const std::optional<Pose2>> truths,
                             const maps::MapModel& model,
                             const localization::BeamModelConfig& config, int every) {
  const localization::PatchStates* states = model.sensor->patch_states();
  if (states != nullptr && states->memory() != localization::PatchMemory::kPerParticle) return {};
  constexpr std::uint64_t kSeed = 1;  // beliefs are exact: nothing is drawn
  WorkerPool pool(1);
  localization::ParticleSet robot;
  robot.resize(1);
  robot.weight[0] = 1.0;
  if (states != nullptr) {
    states->prepare(robot);
    RandomStream random(kSeed, StreamId::kPatchTransition);
    states->draw(robot, 0, random);
  }
  double log_likelihood = 0.0;
  ScanPrediction prediction;
  std::vector<double> deviations;
  std::optional<Stamp> previous;
  for (std::size_t i = 0; i < observations.size(); i += static_cast<std::size_t>(every)) {
    if (!truths[i]) continue;
    const Scan& scan = observations[i].scan;
    robot.set_pose(0, *truths[i]);
    if (states != nullptr) {
      const double step_s = previous ? std::max(0.0, (scan.stamp - *previous).seconds()) : 0.0;
      states->predict(step_s, kSeed, i, robot, pool);
    }
    previous = scan.stamp;

    const localization::ScanBeams beams = localization::select_beams(scan, config.beams);
    const maps::RangeFunction expected_range = model.best_prediction(robot);
    const Pose2 laser = *truths[i] * beams.robot_from_laser;
    for (std::size_t k = 0; k < beams.size(); ++k) {
      if (beams.is_hit[k] == 0) continue;
      const double expected_m =
          std::min(expected_range(laser, beams.bearing_rad[k]), beams.r_max_m);
      deviations.push_back(std::abs(beams.range_m[k] - expected_m));
    }
    double value = 0.0;
    prediction.beams += model.sensor->log_likelihoods(scan, 1.0, robot, std::span(&value, 1), pool);
    log_likelihood += value;
  }
  if (prediction.beams == 0 || deviations.empty()) return {};
  prediction.log_likelihood_per_beam = log_likelihood / static_cast<double>(prediction.beams);
  prediction.median_abs_error_m = statistics::median(std::move(deviations));
  return prediction;
}

}  // namespace strata::pipeline
