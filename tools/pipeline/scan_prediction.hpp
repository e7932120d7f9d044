// SPDX-License-Identifier: Apache-2.0
/// How well a map predicts scans it was not learned from, at the true poses (SPEC F, held-out fit).
#pragma once

#include <optional>
#include <span>

#include "components/maps/map_model.hpp"
#include "core/localization/patch_beam_model.hpp"
#include "core/scan/scan.hpp"
#include "tools/pipeline/comparison.hpp"

namespace strata::pipeline {

/// Mean log-likelihood per beam in use, not tempered, and the median of |z - expected| over the
/// hits. What a patch model believes of its sub-maps follows the scans as they come, so that each
/// scan is predicted from those before it. truths: map_from_robot; scans without one are left out.
/// A model that samples configurations gives no likelihood for a single pose: beams is 0.
[[nodiscard]] ScanPrediction predict_scans(std::span<const Observation> observations,
                                           std::span<const std::optional<Pose2>> truths,
                                           const maps::MapModel& model,
                                           const localization::BeamModelConfig& config, int every);

}  // namespace strata::pipeline
