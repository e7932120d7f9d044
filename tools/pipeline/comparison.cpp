// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/comparison.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <sstream>
#include <utility>

namespace strata::pipeline {
namespace {

using nlohmann::json;

constexpr double kAlpha = 0.05;
constexpr std::uint64_t kBootstrapSeed = 1;
/// Half a cell of the default map: smaller differences are real at most in the statistical sense.
constexpr double kLeastThatMatters_m = 0.025;

std::vector<double> run_means(const ModelResult& model) {
  std::vector<double> means;
  for (const ModelRun& run : model.runs) means.push_back(run.metrics.error_m.mean);
  return means;
}

/// Mean over the runs that have a value.
template <typename Get>
std::optional<double> mean_over_runs(const ModelResult& model, Get get) {
  std::vector<double> values;
  for (const ModelRun& run : model.runs) {
    if (const std::optional<double> value = get(run)) values.push_back(*value);
  }
  if (values.empty()) return std::nullopt;
  return statistics::mean(values);
}

template <typename Get>
double over_runs(const ModelResult& model, Get get) {
  return mean_over_runs(model, [&](const ModelRun& run) { return std::optional<double>(get(run)); })
      .value_or(0.0);
}

json or_null(const std::optional<double>& value) { return value ? json(*value) : json(nullptr); }

/// Median where missing values are the largest; nothing when the median is missing.
std::optional<double> censored_median(std::vector<double> values, std::size_t missing) {
  values.resize(values.size() + missing, std::numeric_limits<double>::infinity());
  if (values.empty()) return std::nullopt;
  const double median = statistics::median(std::move(values));
  return std::isfinite(median) ? std::optional(median) : std::nullopt;
}

json update_time(const ModelResult& model) {
  std::vector<double> all;
  for (const ModelRun& run : model.runs) {
    all.insert(all.end(), run.update_ms.begin(), run.update_ms.end());
  }
  if (all.empty()) return nullptr;
  std::sort(all.begin(), all.end());
  const auto at = [&](double share) {
    return all[static_cast<std::size_t>(share * static_cast<double>(all.size() - 1))];
  };
  return {{"median", at(0.5)}, {"p99", at(0.99)}};
}

json prediction_json(const ScanPrediction& prediction) {
  if (prediction.beams == 0) return nullptr;
  return {{"log_likelihood_per_beam", prediction.log_likelihood_per_beam},
          {"median_abs_error_m", prediction.median_abs_error_m},
          {"beams", prediction.beams}};
}

json interval_json(const std::vector<double>& values) {
  const statistics::Interval ci = statistics::bootstrap_mean(values, 0.95, kBootstrapSeed);
  return {ci.low, ci.high};
}

/// The scans that see a place that changed.
json changed_json(const ModelResult& model) {
  std::vector<double> errors;
  for (const ModelRun& run : model.runs) {
    if (run.changed_error_m) errors.push_back(*run.changed_error_m);
  }
  json error = nullptr;
  if (!errors.empty()) {
    error = {{"mean", statistics::mean(errors)}, {"ci95", interval_json(errors)}};
  }
  return {{"error_m", error},
          {"failure_rate", or_null(mean_over_runs(
                               model, [](const ModelRun& r) { return r.changed_failure_rate; }))},
          {"scan_prediction", prediction_json(pool_predictions(model, &PredictionScore::changed))}};
}

json model_json(const ModelResult& model) {
  const std::vector<double> means = run_means(model);
  const auto lost = std::count_if(model.runs.begin(), model.runs.end(),
                                  [](const ModelRun& run) { return run.metrics.lost; });
  const AdaptationSummary adaptation = summarize_adaptation(model);
  return {
      {"error_m",
       {{"mean", statistics::mean(means)},
        {"median", over_runs(model, [](const ModelRun& r) { return r.metrics.error_m.median; })},
        {"p95", over_runs(model, [](const ModelRun& r) { return r.metrics.error_m.p95; })},
        {"max", over_runs(model, [](const ModelRun& r) { return r.metrics.error_m.max; })},
        {"per_seed", means},
        {"ci95", interval_json(means)}}},
      {"error_rad",
       {{"mean", over_runs(model, [](const ModelRun& r) { return r.metrics.error_rad.mean; })}}},
      {"failure_rate", mean_failure_rate(model)},
      {"lost_runs", lost},
      {"seed_spread_m", or_null(seed_spread_m(model))},
      {"scan_prediction", prediction_json(pool_predictions(model, &PredictionScore::overall))},
      {"where_it_changed", changed_json(model)},
      {"map_bytes", model.map_bytes},
      {"update_ms", update_time(model)},
      {"adaptation_s", or_null(adaptation.s)},
      {"adaptation_scans", or_null(adaptation.scans)},
      {"changes", adaptation.events},
      {"changes_adapted_to", adaptation.adapted},
      {"recall_old_state", or_null(adaptation.recall_old_state)},
      {"old_states", adaptation.old_states},
      {"true_state_probability", or_null(adaptation.true_state_probability)}};
}

/// The pair without its adjusted p-values.
PairedTest compare_pair(const ModelResult& better, const ModelResult& worse,
                        const std::vector<double>& differences) {
  PairedTest test;
  test.better = better.model;
  test.worse = worse.model;
  test.mean_difference_m = statistics::mean(differences);
  test.median_difference_m = statistics::median(differences);
  test.ci95_m = statistics::bootstrap_mean(differences, 0.95, kBootstrapSeed);
  test.cliffs_delta = statistics::cliffs_delta(run_means(worse), run_means(better));
  for (std::size_t i = 0; i < better.runs.size(); ++i) {
    const bool is_lost_better = better.runs[i].metrics.lost;
    const bool is_lost_worse = worse.runs[i].metrics.lost;
    test.lost_only_better += is_lost_better && !is_lost_worse ? 1 : 0;
    test.lost_only_worse += is_lost_worse && !is_lost_better ? 1 : 0;
  }
  return test;
}

json part_json(const TestPartInfo& part) {
  json changes = json::array();
  for (const MetChange& change : part.changes) {
    changes.push_back({{"time_s", change.time_s},
                       {"x_m", change.center_m.x()},
                       {"y_m", change.center_m.y()},
                       {"scans", change.scans},
                       {"appeared_share", change.appeared_share},
                       {"old_state", change.is_old_state}});
  }
  return {{"name", part.name},
          {"train", part.train_s},
          {"test", part.test_s},
          {"scans", part.scans},
          {"changes", changes},
          {"scans_where_it_changed", part.changed_scans},
          {"scans_off_the_map", part.unmapped_scans}};
}

std::string metres(double value) {
  std::ostringstream out;
  out.setf(std::ios::fixed);
  out.precision(3);
  out << value << " m";
  return out.str();
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

std::vector<PairedTest> paired_tests(const Comparison& comparison) {
  std::vector<PairedTest> tests;
  std::vector<double> p_values;
  std::vector<double> p_lost;
  for (std::size_t a = 0; a < comparison.models.size(); ++a) {
    for (std::size_t b = a + 1; b < comparison.models.size(); ++b) {
      const bool a_is_better =
          mean_error_m(comparison.models[a]) <= mean_error_m(comparison.models[b]);
      const ModelResult& better = comparison.models[a_is_better ? a : b];
      const ModelResult& worse = comparison.models[a_is_better ? b : a];
      std::vector<double> differences = run_means(worse);
      const std::vector<double> subtracted = run_means(better);
      for (std::size_t i = 0; i < differences.size(); ++i) differences[i] -= subtracted[i];
      tests.push_back(compare_pair(better, worse, differences));
      p_values.push_back(statistics::wilcoxon_signed_rank(differences));
      p_lost.push_back(
          statistics::mcnemar_exact(tests.back().lost_only_better, tests.back().lost_only_worse));
    }
  }
  const std::vector<double> adjusted = statistics::holm(p_values);
  const std::vector<double> adjusted_lost = statistics::holm(p_lost);
  for (std::size_t i = 0; i < tests.size(); ++i) {
    tests[i].p = adjusted[i];
    tests[i].p_lost = adjusted_lost[i];
    tests[i].significant = adjusted[i] < kAlpha && tests[i].ci95_m.low > 0.0;
  }
  return tests;
}

std::string verdict(const Comparison& comparison, const std::vector<PairedTest>& tests) {
  if (comparison.models.empty()) return "Nothing was compared.";
  const auto best = std::min_element(
      comparison.models.begin(), comparison.models.end(),
      [](const auto& a, const auto& b) { return mean_error_m(a) < mean_error_m(b); });
  std::string beaten;
  std::string alike;
  std::string tied;
  for (const ModelResult& model : comparison.models) {
    if (model.model == best->model) continue;
    const auto test = std::find_if(tests.begin(), tests.end(), [&](const PairedTest& t) {
      return t.better == best->model && t.worse == model.model;
    });
    const bool significant = test != tests.end() && test->significant;
    const bool matters = significant && test->mean_difference_m >= kLeastThatMatters_m;
    std::string& list = matters ? beaten : (significant ? alike : tied);
    list += (list.empty() ? "" : ", ") + model.model + " (" + metres(mean_error_m(model)) + ")";
  }
  const std::size_t units = best->runs.size();
  const std::size_t drives = comparison.parts.size();
  std::string sentence =
      best->model + " has the lowest mean error, " + metres(mean_error_m(*best)) + " over " +
      (drives > 1 ? std::to_string(drives) + " drives with " : std::string()) +
      std::to_string(comparison.seeds) + (comparison.seeds == 1 ? " seed" : " seeds");
  if (!beaten.empty()) sentence += "; significantly below " + beaten;
  if (!alike.empty()) {
    sentence += "; equal for practical purposes, less than half a cell apart: " + alike;
  }
  if (!tied.empty()) sentence += "; no significant difference to " + tied;
  if (beaten.empty()) sentence += "; no difference that matters was shown";
  sentence += ".";
  // The least p that a signed-rank test can reach, times the pairs that Holm's correction counts.
  const double least_p = std::ldexp(2.0, -static_cast<int>(units)) *
                         static_cast<double>(std::max<std::size_t>(1, tests.size()));
  if (least_p >= kAlpha) {
    sentence += " With so few seeds no difference can be significant; use --seeds 20 to decide.";
  }
  return sentence;
}

json to_json(const Comparison& comparison, const std::vector<PairedTest>& tests) {
  json models = json::object();
  for (const ModelResult& model : comparison.models) models[model.model] = model_json(model);
  json wins = json::array();
  for (const PairedTest& test : tests) {
    wins.push_back({{"better", test.better},
                    {"worse", test.worse},
                    {"mean_difference_m", test.mean_difference_m},
                    {"median_difference_m", test.median_difference_m},
                    {"ci95_m", {test.ci95_m.low, test.ci95_m.high}},
                    {"p_holm", test.p},
                    {"cliffs_delta", test.cliffs_delta},
                    {"significant", test.significant},
                    {"lost_only_better", test.lost_only_better},
                    {"lost_only_worse", test.lost_only_worse},
                    {"p_lost_holm", test.p_lost}});
  }
  json parts = json::array();
  for (const TestPartInfo& part : comparison.parts) parts.push_back(part_json(part));
  const TestPartInfo first = comparison.parts.empty() ? TestPartInfo{} : comparison.parts.front();
  return {{"log", comparison.log},
          {"via", comparison.via},
          {"train", first.train_s},
          {"test", first.test_s},
          {"parts", parts},
          {"seeds", comparison.seeds},
          {"truth", comparison.truth == TruthKind::kGiven ? "given" : "joint trajectory"},
          {"models", models},
          {"wins", wins},
          {"verdict", verdict(comparison, tests)}};
}

}  // namespace strata::pipeline
