// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/localize.hpp"

#include <chrono>
#include <cmath>
#include <limits>

#include "core/geometry/angle.hpp"
#include "tools/pipeline/map_fit.hpp"

namespace strata::pipeline {
namespace {

ScanError error_of(Stamp stamp, const Pose2& pose, const Pose2& truth, double score) {
  return {stamp, translation_distance(pose, truth),
          std::abs(angle_difference(pose.theta, truth.theta)), score};
}

}  // namespace

void show_particles(const localization::ParticleSet& particles, std::vector<float>& shown) {
  double total = 0.0;
  for (const double weight : particles.weight) total += weight;
  if (!(total > 0.0)) {
    shown.insert(shown.end(), 2 * kShownParticles, std::numeric_limits<float>::quiet_NaN());
    return;
  }
  std::size_t at = 0;
  double reached = particles.weight.front();
  for (std::size_t k = 0; k < kShownParticles; ++k) {
    const double step = (static_cast<double>(k) + 0.5) * total / kShownParticles;
    while (reached < step && at + 1 < particles.size()) reached += particles.weight[++at];
    shown.push_back(static_cast<float>(particles.x_m[at]));
    shown.push_back(static_cast<float>(particles.y_m[at]));
  }
}

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
    show_particles(localizer.particles(), run.shown_particles);
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
