// SPDX-License-Identifier: Apache-2.0
/// Poses right and wrong, and what the localizer's score is made of at each: to learn its
/// calibration from, and to show it on.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/localization/pose_score.hpp"
#include "tools/laboratory/experiments/verdict_worlds.hpp"

namespace strata::experiments {

/// A weighed scan whose truth is known.
struct ScoreSample {
  std::size_t drive = 0;     ///< of the same number: one behind the other
  bool is_tracked = false;   ///< of a drive that was tracked from the truth on, as most are
  bool is_anywhere = false;  ///< of a drive that began nowhere
  localization::ScoreEvidence evidence = {};
  double score = 0.0;
  double error_m = 0.0;  ///< of the mean pose
  bool is_lost = false;  ///< the verdict
};

/// A pose further off than this is wrong.
inline constexpr double kWrongPose_m = 0.5;

/// Localizes the world's drive once from the truth on, and `times` times each: from nowhere; from a
/// pose that is 1 to 3.1 m off; and carried away after 100 scans to where its map goes on
/// elsewhere. model: as count_verdicts. Deterministic.
[[nodiscard]] std::vector<ScoreSample> score_samples(const VerdictWorld& world,
                                                     const std::string& model, int times);

}  // namespace strata::experiments
