// SPDX-License-Identifier: Apache-2.0
/// How well a map predicts scans it was not learned from, at the true poses, and how soon it
/// follows a change (docs/theory/evaluation.md, "Held-out fit" and "Changes").
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "components/maps/map_model.hpp"
#include "components/maps/maps_folder.hpp"
#include "core/patch_beams/patch_beam_model.hpp"
#include "core/scan/scan.hpp"
#include "tools/pipeline/event_follower.hpp"

namespace strata::pipeline {

/// Fit of a map to scans.
struct ScanPrediction {
  double log_likelihood_per_beam = 0.0;  ///< nats, not tempered
  double median_abs_error_m = 0.0;       ///< of |z - expected| over the hits
  std::size_t beams = 0;
};

/// Fit of one scan, of those that count for the overall fit.
struct ScanFit {
  double time_s = 0.0;  ///< since the part began
  double nats = 0.0;
  std::size_t beams = 0;
};

struct PredictionScore {
  ScanPrediction overall;
  ScanPrediction changed;  ///< over the beams that reach places that changed
  std::vector<EventOutcome> events;
  std::vector<ScanFit> series;
  std::vector<double> query_ms;  ///< to expect one scan; not deterministic
};

/// Which scans and beams are predicted.
struct PredictionChoice {
  int every = 5;  ///< every so many scans count for the overall fit
  /// Only beams that no localizer with this beam selection looks at.
  bool unseen_beams = false;
};

/// Follows the test scans in order with what the model believes, so that each scan is predicted
/// from those before it; all scans that see a changed place count for the rest than the overall
/// fit. With the estimates of a localizer in place of the truth it needs no truth at all.
[[nodiscard]] PredictionScore score_predictions(const TestScans& test, const maps::MapModel& model,
                                                const localization::BeamModelConfig& config,
                                                const PredictionChoice& choice);

/// The adaptation of a timescale model while its memory, a copy of that in the maps, goes on
/// learning at the true poses: each scan is predicted before the memory observes it. One outcome an
/// event; recall and state probability stay empty.
[[nodiscard]] std::vector<EventOutcome> follow_memory(
    const TestScans& test, const maps::Maps& maps, const maps::MapModel& model,
    const patch_beams::PatchBeamModelConfig& sensor);

}  // namespace strata::pipeline
