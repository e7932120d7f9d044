// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/localization_metrics.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace strata::pipeline {
namespace {

/// One scan a second, with the given distances.
std::vector<ScanError> run_of(const std::vector<double>& distances_m) {
  std::vector<ScanError> errors;
  for (std::size_t i = 0; i < distances_m.size(); ++i) {
    errors.push_back({Stamp::from_seconds(100.0 + static_cast<double>(i)), distances_m[i], 0.0});
  }
  return errors;
}

TEST(Summarize, GivesClosedFormsOfOneToFive) {
  const ErrorSummary summary = summarize({5.0, 1.0, 4.0, 2.0, 3.0});
  EXPECT_DOUBLE_EQ(summary.mean, 3.0);
  EXPECT_DOUBLE_EQ(summary.median, 3.0);
  EXPECT_DOUBLE_EQ(summary.p95, 5.0);
  EXPECT_DOUBLE_EQ(summary.max, 5.0);
  EXPECT_NEAR(summary.rmse, std::sqrt(11.0), 1e-12);
}

TEST(Summarize, AveragesTheMiddlePairOfAnEvenCount) {
  EXPECT_DOUBLE_EQ(summarize({4.0, 1.0, 2.0, 3.0}).median, 2.5);
}

TEST(Summarize, OfNothingIsZero) { EXPECT_EQ(summarize({}).max, 0.0); }

TEST(EvaluateRun, ConvergesWhenTheErrorStaysLowForFiveSeconds) {
  // Low at 1 s for too short a time, then low for good from 4 s on.
  const auto metrics = evaluate_run(run_of({2, 0.1, 0.1, 0.9, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1}));
  ASSERT_TRUE(metrics.converged_after_s.has_value());
  EXPECT_DOUBLE_EQ(*metrics.converged_after_s, 4.0);
  EXPECT_DOUBLE_EQ(metrics.failure_rate, 0.0);
  EXPECT_FALSE(metrics.lost);
}

TEST(EvaluateRun, CountsFailuresOnlyAfterConvergence) {
  const auto metrics = evaluate_run(run_of({0.9, 0.9, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.7, 0.1}));
  EXPECT_DOUBLE_EQ(*metrics.converged_after_s, 2.0);
  EXPECT_DOUBLE_EQ(metrics.failure_rate, 1.0 / 8.0);
}

TEST(EvaluateRun, IsLostWhenFarForFiveSecondsAfterConvergence) {
  EXPECT_TRUE(evaluate_run(run_of({0, 0, 0, 0, 0, 0, 2, 2, 2, 2, 2, 2})).lost);
  EXPECT_FALSE(evaluate_run(run_of({0, 0, 0, 0, 0, 0, 2, 2, 2, 2, 0, 2})).lost);
}

TEST(EvaluateRun, ThatNeverConvergesFailsThroughout) {
  const auto metrics = evaluate_run(run_of({3, 3, 3, 3, 3, 3, 3}));
  EXPECT_FALSE(metrics.converged_after_s.has_value());
  EXPECT_DOUBLE_EQ(metrics.failure_rate, 1.0);
  EXPECT_TRUE(metrics.lost);
}

TEST(EvaluateRun, TellsWhenALostRunCameBack) {
  std::vector<double> distances(6, 0.1);
  distances.insert(distances.end(), 8, 2.0);  // lost from 6 s on, for 8 s
  distances.insert(distances.end(), 7, 0.2);
  const auto metrics = evaluate_run(run_of(distances));
  EXPECT_TRUE(metrics.lost);
  ASSERT_TRUE(metrics.recovered_after_s.has_value());
  EXPECT_DOUBLE_EQ(*metrics.recovered_after_s, 8.0);
  distances.resize(14);
  EXPECT_FALSE(evaluate_run(run_of(distances)).recovered_after_s.has_value());
}

}  // namespace
}  // namespace strata::pipeline
