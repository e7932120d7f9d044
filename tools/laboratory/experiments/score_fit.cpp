// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/score_fit.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace strata::experiments {
namespace {

using localization::ScoreEvidence;

constexpr std::size_t kParts = ScoreEvidence::kParts;
constexpr int kSize = static_cast<int>(kParts) + 1;
using Vector = Eigen::Matrix<double, kSize, 1>;
using Matrix = Eigen::Matrix<double, kSize, kSize>;
using Groups = std::vector<std::vector<ScoreSample>>;

constexpr double kRidge = 1e-4;
constexpr int kSteps = 20;
constexpr int kRounds = 6;
constexpr double kSure = 0.9;

Vector row_of(const ScoreSample& sample) {
  Vector row;
  for (std::size_t i = 0; i < kParts; ++i) {
    row(static_cast<int>(i)) = sample.evidence.part[i];
  }
  row(kSize - 1) = 1.0;
  return row;
}

double probability(double log_odds) { return 1.0 / (1.0 + std::exp(-log_odds)); }

/// One fit with the doubts as they are.
void regress(const Groups& groups, Vector& weights) {
  for (int step = 0; step < kSteps; ++step) {
    Matrix curvature = Matrix::Identity() * kRidge;
    Vector slope = -kRidge * weights;
    for (const auto& samples : groups) {
      const double share = 1.0 / static_cast<double>(std::max<std::size_t>(samples.size(), 1));
      for (const ScoreSample& sample : samples) {
        const Vector row = row_of(sample);
        const double p = probability(row.dot(weights));
        slope += share * ((sample.error_m <= kWrongPose_m ? 1.0 : 0.0) - p) * row;
        curvature += share * p * (1.0 - p) * row * row.transpose();
      }
    }
    weights += curvature.ldlt().solve(slope);
  }
}

/// What these weights make of the doubts. Those of a search, which are 1 whatever the weights say,
/// are kept while they are.
void follow_doubts(const Vector& weights, Groups& groups) {
  for (auto& samples : groups) {
    double doubt = 0.0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      double& part = samples[i].evidence.part[ScoreEvidence::kDoubt];
      const bool is_first = i == 0 || samples[i].drive != samples[i - 1].drive;
      if (is_first) doubt = samples[i].is_anywhere ? 1.0 : 0.0;
      part = 0.0;
      doubt = localization::next_doubt(doubt, row_of(samples[i]).dot(weights));
      part = doubt;
    }
  }
}

/// How much lower the log-odds must be for the share of wrong ones among the sure to be so small.
double lowered_by(const Groups& groups, const Vector& weights, double wrong_share) {
  const double sure = std::log(kSure / (1.0 - kSure));
  for (double lower = 0.0; lower < 5.0; lower += 0.05) {
    std::size_t all = 0;
    std::size_t wrong = 0;
    for (const auto& samples : groups) {
      for (const ScoreSample& sample : samples) {
        if (row_of(sample).dot(weights) - lower < sure) continue;
        ++all;
        if (sample.error_m > kWrongPose_m) ++wrong;
      }
    }
    if (static_cast<double>(wrong) <= wrong_share * static_cast<double>(all)) return lower;
  }
  return 5.0;
}

}  // namespace

ScoreWeights fit_score(std::vector<std::vector<ScoreSample>> groups, double wrong_share) {
  Vector weights = Vector::Zero();
  regress(groups, weights);
  for (int round = 0; round < kRounds; ++round) {
    follow_doubts(weights, groups);
    regress(groups, weights);
  }
  follow_doubts(weights, groups);
  ScoreWeights result;
  for (std::size_t i = 0; i < kParts; ++i) result.weights[i] = weights(static_cast<int>(i));
  result.bias = weights(kSize - 1);
  result.caution = lowered_by(groups, weights, wrong_share);
  return result;
}

}  // namespace strata::experiments
