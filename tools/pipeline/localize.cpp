// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/localize.hpp"

#include <chrono>
#include <cmath>

#include "core/geometry/angle.hpp"
#include "tools/pipeline/map_fit.hpp"

namespace strata::pipeline {
namespace {

ScanError error_of(Stamp stamp, const Pose2& pose, const Pose2& truth, double score) {
  return {stamp, translation_distance(pose, truth),
          std::abs(angle_difference(pose.theta, truth.theta)), score};
}

}  // namespace

LocalizationRun localize(std::span<const Observation> observations,
                         std::span<const std::optional<Pose2>> truths, const maps::MapModel& model,
                         const ReflectionGrid& free_space,
                         const localization::LocalizerConfig& config,
                         const LocalizationStart& start, std::uint64_t seed, int threads,
                         Progress* progress, MapFit* fit, refinement::PoseRefiner* refiner) {
  LocalizationRun run;
  report_progress(progress, "localize", 0, observations.size());
  localization::Localizer localizer(config, model.sensor, seed, threads);
  localizer.set_free_space(free_space);
  if (start.map_from_robot) {
    localizer.initialize(*start.map_from_robot);
  } else {
    localizer.initialize_global(free_space);
  }
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const Observation& observation = observations[i];
    const auto begin = std::chrono::steady_clock::now();
    const localization::LocalizationResult result = localizer.update(observation);
    std::optional<Pose2Gaussian> refined;
    if (refiner != nullptr) refined = refiner->refine(observation.scan, result);
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - begin;
    run.update_ms.push_back(took.count());
    run.add(observation.scan.stamp, result, localizer, refined);
    if (fit != nullptr) fit->add(observation, result, localizer.particles());
    if (i < truths.size() && truths[i]) {
      run.errors.push_back(
          {observation.scan.stamp, localization::weighted_error(localizer.particles(), *truths[i]),
           localization::weighted_heading_error(localizer.particles(), *truths[i]), result.score});
    }
    if (refined && i < truths.size() && truths[i]) {
      run.refined_errors.push_back(
          error_of(observation.scan.stamp, refined->mean, *truths[i], result.score));
    }
    report_progress(progress, "localize", i + 1, observations.size());
  }
  return run;
}

}  // namespace strata::pipeline
