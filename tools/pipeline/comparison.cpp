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

namespace {

ScanPrediction pool(const std::vector<ScanPrediction>& parts) {
  ScanPrediction pooled;
  std::vector<double> medians;
  for (const ScanPrediction& one : parts) {
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

}  // namespace

ScanPrediction pool_predictions(const ModelResult& model, ScanPrediction PredictionScore::*which) {
  std::vector<ScanPrediction> parts;
  for (const PredictionScore& score : model.scores) parts.push_back(score.*which);
  return pool(parts);
}

ScanPrediction pool_own_pose(const ModelResult& model) { return pool(model.own_pose); }

std::optional<double> seed_spread_m(const ModelResult& model) {
  std::map<std::size_t, std::vector<const ModelRun*>> by_part;
  for (const ModelRun& run : model.runs) by_part[run.part].push_back(&run);
  double sum = 0.0;
  std::size_t count = 0;
  for (const auto& [part, runs] : by_part) {
    if (runs.size() < 2) continue;
    for (std::size_t i = 0; i < runs.front()->estimates.size(); ++i) {
      Eigen::Vector2d mean = Eigen::Vector2d::Zero();
      for (const ModelRun* run : runs) mean += run->estimates[i].translation();
      mean /= static_cast<double>(runs.size());
      for (const ModelRun* run : runs) sum += (run->estimates[i].translation() - mean).norm();
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
  std::vector<double> mixed;
  for (const PredictionScore& score : model.scores) {
    for (const EventOutcome& outcome : score.events) {
      ++summary.events;
      mixed.push_back(outcome.mixed_share);
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
  if (!mixed.empty()) summary.mixed_share = statistics::mean(mixed);
  return summary;
}

RecoverySummary summarize_recovery(const ModelResult& model) {
  RecoverySummary summary;
  std::vector<double> seconds;
  for (const ModelRun& run : model.runs) {
    summary.lost += run.metrics.lost ? 1 : 0;
    if (run.metrics.recovered_after_s) seconds.push_back(*run.metrics.recovered_after_s);
  }
  summary.recovered = seconds.size();
  summary.s = censored_median(std::move(seconds), summary.lost - summary.recovered);
  return summary;
}

std::optional<double> false_adaptation_share(const ModelResult& model) {
  FalseAdaptation sum;
  for (const FalseAdaptation& part : model.false_adaptation) {
    sum.right += part.right;
    sum.wrong += part.wrong;
  }
  if (sum.right == 0) return std::nullopt;
  return static_cast<double>(sum.wrong) / static_cast<double>(sum.right);
}

PlanningScore pool_planning(const ModelResult& model) {
  PlanningScore pooled;
  std::vector<double> variations;
  std::vector<double> steps_m;
  for (const PlanningScore& part : model.planning) {
    pooled.queries += part.queries;
    pooled.without_path += part.without_path;
    pooled.blocked += part.blocked;
    if (part.length_cv) variations.push_back(*part.length_cv);
    if (part.frechet_m) steps_m.push_back(*part.frechet_m);
  }
  if (!variations.empty()) pooled.length_cv = statistics::mean(variations);
  if (!steps_m.empty()) pooled.frechet_m = statistics::mean(steps_m);
  return pooled;
}

std::optional<statistics::Interval> fit_interval(const ModelResult& model,
                                                 const ModelResult* minus) {
  constexpr double kBlock_s = 30.0;
  std::vector<double> nats;
  std::vector<double> beams;
  double length_s = 0.0;
  for (std::size_t p = 0; p < model.scores.size(); ++p) {
    const std::vector<ScanFit>& series = model.scores[p].series;
    if (series.empty()) continue;
    length_s += series.back().time_s - series.front().time_s;
    for (std::size_t i = 0; i < series.size(); ++i) {
      double value = series[i].nats;
      if (minus != nullptr) value -= minus->scores[p].series[i].nats;
      nats.push_back(value);
      beams.push_back(static_cast<double>(series[i].beams));
    }
  }
  if (length_s < 2.0 * kBlock_s || statistics::mean(beams) == 0.0) return std::nullopt;
  const double per_second = static_cast<double>(nats.size()) / length_s;
  const auto block = static_cast<std::size_t>(std::ceil(kBlock_s * per_second));
  return statistics::moving_block_ratio(nats, beams, std::min(block, nats.size()), 0.95,
                                        kBootstrapSeed);
}

}  // namespace strata::pipeline
