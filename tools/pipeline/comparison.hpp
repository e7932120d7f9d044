// SPDX-License-Identifier: Apache-2.0
/// The outcome of comparing map models on one log: who localizes better, and is it more than
/// chance.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/pipeline/localization_metrics.hpp"
#include "tools/statistics/statistics.hpp"

namespace strata::pipeline {

/// Where the poses that errors are measured against come from.
enum class TruthKind { kGiven, kJointTrajectory };

/// How well a map predicts scans that it was not learned from, at the true poses (SPEC F).
struct ScanPrediction {
  double log_likelihood_per_beam = 0.0;  ///< nats
  double median_abs_error_m = 0.0;
  std::size_t beams = 0;
};

/// One model with one seed.
struct ModelRun {
  std::uint64_t seed = 0;
  std::vector<ScanError> errors;
  std::vector<double> update_ms;
  LocalizationMetrics metrics;
};

/// P(configuration | data) of one sub-map over the test part.
struct StateTrace {
  int submap = 0;
  std::vector<double> time_s;
  std::vector<std::vector<double>> probability;  ///< per configuration, one entry a time
};

struct ModelResult {
  std::string model;
  std::size_t map_bytes = 0;
  ScanPrediction prediction;
  std::vector<ModelRun> runs;      ///< in the order of the seeds, the same for every model
  std::vector<StateTrace> states;  ///< of the first seed; patch models only
};

struct Comparison {
  std::string log;
  std::array<double, 2> train_s{};  ///< seconds from the start of the log
  std::array<double, 2> test_s{};
  TruthKind truth = TruthKind::kGiven;
  std::vector<ModelResult> models;
};

/// A model against another on the mean error of each seed.
struct PairedTest {
  std::string better;
  std::string worse;
  double mean_difference_m = 0.0;  ///< worse minus better
  statistics::Interval ci95_m;
  double p = 1.0;  ///< Wilcoxon, Holm-adjusted over all pairs
  bool significant = false;
};

/// Every pair of models; differences that the interval and the test both support are significant.
[[nodiscard]] std::vector<PairedTest> paired_tests(const Comparison& comparison);

/// One sentence: which model localizes best here, or that there is no difference.
[[nodiscard]] std::string verdict(const Comparison& comparison,
                                  const std::vector<PairedTest>& tests);

/// comparison.json of the contracts.
[[nodiscard]] nlohmann::json to_json(const Comparison& comparison,
                                     const std::vector<PairedTest>& tests);

/// Mean over seeds of each run's mean error.
[[nodiscard]] double mean_error_m(const ModelResult& model);
/// Mean over seeds of the failure rate.
[[nodiscard]] double mean_failure_rate(const ModelResult& model);

}  // namespace strata::pipeline
