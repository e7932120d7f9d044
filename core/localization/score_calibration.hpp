// SPDX-License-Identifier: Apache-2.0
/// The weights of the score, learned by
/// `strata-experiments score` (docs/theory/localization_score.md, "Calibration").
#pragma once

#include <array>

#include "core/localization/pose_score.hpp"

namespace strata::localization {

/// Of the parts of ScoreEvidence, in their order; log-odds are kScoreBias + sum of weight x part.
inline constexpr std::array<double, ScoreEvidence::kParts> kScoreWeights{
    0.73, 1.39, 1.08, 1.82, 2.76, 4.88, 0.30, 0.12, 3.56, 4.34, 4.20, -3.12};
inline constexpr double kScoreBias = -9.23;
/// The score is of log-odds lower by this, since a place that looks like the right one cannot be
/// told from it by what is seen there.
inline constexpr double kScoreCaution = 1.35;

}  // namespace strata::localization
