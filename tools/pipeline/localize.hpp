// SPDX-License-Identifier: Apache-2.0
/// One localization run on recorded observations, without DDS.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "components/maps/localization_files.hpp"
#include "components/maps/map_model.hpp"
#include "core/base/progress.hpp"
#include "core/localization/localizer.hpp"
#include "core/refinement/pose_refiner.hpp"
#include "core/scan/scan.hpp"
#include "tools/pipeline/localization_metrics.hpp"

namespace strata::pipeline {

class MapFit;

/// So many particles of each scan are kept, for pages that show them.
inline constexpr std::size_t kShownParticles = 20;

/// The record of a run, and what only the direct path knows.
struct LocalizationRun : maps::LocalizationRecord {
  std::vector<ScanError> errors;          ///< of the scans whose truth is known
  std::vector<ScanError> refined_errors;  ///< ... and whose pose was refined: its distance
  std::vector<double> update_ms;
  /// kShownParticles of each scan, x and y in turn [m], as often as they weigh.
  std::vector<float> shown_particles;
};

/// Appends kShownParticles of a set: those at even steps of the sum of weights. None of a set
/// without weight: NaN.
void show_particles(const localization::ParticleSet& particles, std::vector<float>& shown);

struct LocalizationStart {
  /// Nothing: global, over the free cells of `free_space`.
  std::optional<Pose2Gaussian> map_from_robot;
};

/// truths: empty, or map_from_robot of each observation where known. fit: takes up each scan; may
/// be null. refiner: refines what it can; may be null. Deterministic but for update_ms.
[[nodiscard]] LocalizationRun localize(std::span<const Observation> observations,
                                       std::span<const std::optional<Pose2>> truths,
                                       const maps::MapModel& model,
                                       const ReflectionGrid& free_space,
                                       const localization::LocalizerConfig& config,
                                       const LocalizationStart& start, std::uint64_t seed,
                                       int threads, Progress* progress, MapFit* fit = nullptr,
                                       refinement::PoseRefiner* refiner = nullptr);

}  // namespace strata::pipeline
