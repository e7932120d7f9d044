// SPDX-License-Identifier: Apache-2.0
/// comparison.json
#include <algorithm>
#include <utility>

#include "tools/pipeline/comparison.hpp"
#include "tools/pipeline/equal_memory.hpp"
#include "tools/pipeline/over_runs.hpp"

namespace strata::pipeline {
namespace {

using nlohmann::json;

json or_null(const std::optional<double>& value) { return value ? json(*value) : json(nullptr); }

json median_and_p99(std::vector<double> all) {
  if (all.empty()) return nullptr;
  std::sort(all.begin(), all.end());
  const auto at = [&](double share) {
    return all[static_cast<std::size_t>(share * static_cast<double>(all.size() - 1))];
  };
  return {{"median", at(0.5)}, {"p99", at(0.99)}};
}

json update_time(const ModelResult& model) {
  std::vector<double> all;
  for (const ModelRun& run : model.runs) {
    all.insert(all.end(), run.update_ms.begin(), run.update_ms.end());
  }
  return median_and_p99(std::move(all));
}

json query_time(const ModelResult& model) {
  std::vector<double> all;
  for (const PredictionScore& score : model.scores) {
    all.insert(all.end(), score.query_ms.begin(), score.query_ms.end());
  }
  return median_and_p99(std::move(all));
}

json planning_json(const ModelResult& model) {
  const PlanningScore planning = pool_planning(model);
  if (planning.queries == 0) return nullptr;
  const auto share = [&](std::size_t count) {
    return static_cast<double>(count) / static_cast<double>(planning.queries);
  };
  return {{"queries", planning.queries},
          {"no_path_rate", share(planning.without_path)},
          {"blocked_path_rate", share(planning.blocked)},
          {"path_length_cv", or_null(planning.length_cv)},
          {"frechet_m", or_null(planning.frechet_m)}};
}

json prediction_json(const ScanPrediction& prediction) {
  if (prediction.beams == 0) return nullptr;
  return {{"log_likelihood_per_beam", prediction.log_likelihood_per_beam},
          {"median_abs_error_m", prediction.median_abs_error_m},
          {"beams", prediction.beams}};
}

json fit_json(const ModelResult& model) {
  json fit = prediction_json(pool_predictions(model, &PredictionScore::overall));
  if (fit.is_null()) return fit;
  const auto ci = fit_interval(model);
  fit["ci95"] = ci ? json({ci->low, ci->high}) : json(nullptr);
  return fit;
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
          {"old_state_error_m",
           or_null(mean_over_runs(model, [](const ModelRun& r) { return r.old_state_error_m; }))},
          {"new_state_error_m",
           or_null(mean_over_runs(model, [](const ModelRun& r) { return r.new_state_error_m; }))},
          {"scan_prediction", prediction_json(pool_predictions(model, &PredictionScore::changed))}};
}

json memory_json(const ModelResult& model) {
  json points = json::array();
  for (const MemoryPoint& point : model.memory) {
    points.push_back({{"setting", point.setting},
                      {"bytes", point.bytes},
                      {"lost_runs", point.lost_runs},
                      {"error_m",
                       {{"mean", statistics::mean(point.run_means_m)},
                        {"per_seed", point.run_means_m},
                        {"ci95", interval_json(point.run_means_m)}}}});
  }
  return points;
}

json equal_memory_json(const Comparison& comparison) {
  json budgets = json::array();
  for (const MemoryBudget& budget : equal_memory(comparison)) {
    json models = json::object();
    for (std::size_t m = 0; m < comparison.models.size(); ++m) {
      const MemoryPoint* point = budget.points[m];
      if (comparison.models[m].memory.empty()) continue;
      models[comparison.models[m].model] =
          point == nullptr ? json(nullptr)
                           : json({{"setting", point->setting},
                                   {"bytes", point->bytes},
                                   {"mean_error_m", statistics::mean(point->run_means_m)}});
    }
    budgets.push_back({{"bytes", budget.bytes}, {"models", models}});
  }
  return budgets;
}

json model_json(const ModelResult& model) {
  const std::vector<double> means = run_means(model);
  const RecoverySummary recovery = summarize_recovery(model);
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
       {{"mean", over_runs(model, [](const ModelRun& r) { return r.metrics.error_rad.mean; })},
        {"median", over_runs(model, [](const ModelRun& r) { return r.metrics.error_rad.median; })},
        {"p95", over_runs(model, [](const ModelRun& r) { return r.metrics.error_rad.p95; })},
        {"max", over_runs(model, [](const ModelRun& r) { return r.metrics.error_rad.max; })}}},
      {"failure_rate", mean_failure_rate(model)},
      {"lost_runs", recovery.lost},
      {"recovered_runs", recovery.recovered},
      {"recovery_s", or_null(recovery.s)},
      {"seed_spread_m", or_null(seed_spread_m(model))},
      {"scan_prediction", fit_json(model)},
      {"own_pose_prediction", prediction_json(pool_own_pose(model))},
      {"where_it_changed", changed_json(model)},
      {"map_bytes", model.map_bytes},
      {"resident_bytes", model.resident_bytes},
      {"error_against_bytes", memory_json(model)},
      {"update_ms", update_time(model)},
      {"query_ms", query_time(model)},
      {"false_adaptation", or_null(false_adaptation_share(model))},
      {"planning", planning_json(model)},
      {"half_changed_share", or_null(adaptation.mixed_share)},
      {"adaptation_s", or_null(adaptation.s)},
      {"adaptation_scans", or_null(adaptation.scans)},
      {"changes", adaptation.events},
      {"changes_adapted_to", adaptation.adapted},
      {"recall_old_state", or_null(adaptation.recall_old_state)},
      {"old_states", adaptation.old_states},
      {"true_state_probability", or_null(adaptation.true_state_probability)}};
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

}  // namespace

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
          {"equal_memory", equal_memory_json(comparison)},
          {"verdict", verdict(comparison, tests)}};
}

}  // namespace strata::pipeline
