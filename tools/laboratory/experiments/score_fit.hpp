// SPDX-License-Identifier: Apache-2.0
/// Learns the weights of the localizer's score from samples.
#pragma once

#include <array>
#include <vector>

#include "tools/laboratory/experiments/score_samples.hpp"

namespace strata::experiments {

/// As core/localization/score_calibration.hpp has them.
struct ScoreWeights {
  std::array<double, localization::ScoreEvidence::kParts> weights{};
  double bias = 0.0;
  double caution = 0.0;
};

/// Logistic regression by Newton's method, with a ridge of 1e-4; each group (log or set of worlds)
/// weighs the same. Doubt hangs on the weights: it is followed anew with those found, six times.
/// Then log-odds are lowered (caution) until at most `wrong_share` of the samples with a score of
/// 0.9 or more are wrong. Deterministic.
[[nodiscard]] ScoreWeights fit_score(std::vector<std::vector<ScoreSample>> groups,
                                     double wrong_share);

}  // namespace strata::experiments
