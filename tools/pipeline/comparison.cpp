// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/comparison.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "tools/pipeline/over_runs.hpp"

namespace strata::pipeline {
namespace {

/// Median where missing values are the largest; nothing when the median is missing.
std::optional<double> censored_median(std::vector<double> values, std::size_t missing) {
  values.resize(values.size() + missing, std::numeric_limits<double>::infinity());
  if (values.empty()) return std::nullopt;
  const double median = statistics::median(std::move(values));
  return std::isfinite(median) ? std::optional(median) : std::nullopt;
}

}  // namespace

double mean_error_m(const ModelResult& model) {
  return over_runs(model, [](const ModelRun& run) { return run.metrics.error_m.mean; });
}

double mean_failure_rate(const ModelResult& model) {
  return over_runs(model, [](const ModelRun& run) { return run.metrics.failure_rate; });
}

ScanPrediction pool_predictions(const ModelResult& model, ScanPrediction PredictionScore::*which) {
  ScanPrediction pooled;
  std::vector<double> medians;
  for (const PredictionScore& score : model.scores) {
    const ScanPrediction& one = score.*which;
    if (one.beams == 0) continue;
    pooled.log_likelihood_per_beam += one.log_likelihood_per_beam * static_cast<double>(one.beams);
    pooled.beams += one.beams;
    medians.push_back(one.median_abs_error_m);
  }
  if (pooled.beams == 0) return pooled;
  pooled.log_likelihood_per_beam /= static_cast<double>(pooled.beams);
  pooled.median_abs_error_m = statistics::median(std::move(medians));
  return pooled;
}

std::optional<double> seed_spread_m(const ModelResult& model) {
  std::map<std::size_t, std::vector<const ModelRun*>> by_part;
  for (const ModelRun& run : model.runs) by_part[run.part].push_back(&run);
  double sum = 0.0;
  std::size_t count = 0;
  for (const auto& [part, runs] : by_part) {
    if (runs.size() < 2) continue;
    for (std::size_t i = 0; i < runs.front()->estimates_m.size(); ++i) {
      Eigen::Vector2d mean = Eigen::Vector2d::Zero();
      for (const ModelRun* run : runs) mean += run->estimates_m[i];
      mean /= static_cast<double>(runs.size());
      for (const ModelRun* run : runs) sum += (run->estimates_m[i] - mean).norm();
      count += runs.size();
    }
  }
  if (count == 0) return std::nullopt;
  return sum / static_cast<double>(count);
}

AdaptationSummary summarize_adaptation(const ModelResult& model) {
  AdaptationSummary summary;
  std::vector<double> scans;
  std::vector<double> seconds;
  std::vector<double> recalls;
  std::vector<double> probabilities;
  for (const PredictionScore& score : model.scores) {
    for (const EventOutcome& outcome : score.events) {
      ++summary.events;
      if (outcome.adapted_after_scans) scans.push_back(*outcome.adapted_after_scans);
      if (outcome.adapted_after_s) seconds.push_back(*outcome.adapted_after_s);
      if (outcome.recall) recalls.push_back(*outcome.recall);
      if (outcome.true_state_probability) probabilities.push_back(*outcome.true_state_probability);
    }
  }
  summary.adapted = scans.size();
  summary.old_states = recalls.size();
  const std::size_t never = summary.events - summary.adapted;
  summary.scans = censored_median(std::move(scans), never);
  summary.s = censored_median(std::move(seconds), never);
  if (!recalls.empty()) summary.recall_old_state = statistics::mean(recalls);
  if (!probabilities.empty()) summary.true_state_probability = statistics::mean(probabilities);
  return summary;
}

}  // namespace strata::pipeline
