// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/comparison.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

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

template <typename Get>
double over_runs(const ModelResult& model, Get get) {
  double sum = 0.0;
  for (const ModelRun& run : model.runs) sum += get(run);
  return sum / static_cast<double>(model.runs.size());
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

json model_json(const ModelResult& model) {
  const std::vector<double> means = run_means(model);
  const statistics::Interval ci = statistics::bootstrap_mean(means, 0.95, kBootstrapSeed);
  std::size_t lost = 0;
  for (const ModelRun& run : model.runs) lost += run.metrics.lost ? 1 : 0;
  json result = {
      {"error_m",
       {{"mean", statistics::mean(means)},
        {"median", over_runs(model, [](const ModelRun& r) { return r.metrics.error_m.median; })},
        {"p95", over_runs(model, [](const ModelRun& r) { return r.metrics.error_m.p95; })},
        {"max", over_runs(model, [](const ModelRun& r) { return r.metrics.error_m.max; })},
        {"per_seed", means},
        {"ci95", {ci.low, ci.high}}}},
      {"error_rad",
       {{"mean", over_runs(model, [](const ModelRun& r) { return r.metrics.error_rad.mean; })}}},
      {"failure_rate", mean_failure_rate(model)},
      {"lost_runs", lost},
      {"map_bytes", model.map_bytes},
      {"update_ms", update_time(model)},
      // These need the true states over time, which this version does not take; null, not zero.
      {"adaptation_s", nullptr},
      {"adaptation_scans", nullptr},
      {"recall_old_state", nullptr}};
  if (model.prediction.beams > 0) {
    result["scan_prediction"] = {
        {"log_likelihood_per_beam", model.prediction.log_likelihood_per_beam},
        {"median_abs_error_m", model.prediction.median_abs_error_m},
        {"beams", model.prediction.beams}};
  } else {
    result["scan_prediction"] = nullptr;
  }
  return result;
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

std::vector<PairedTest> paired_tests(const Comparison& comparison) {
  std::vector<PairedTest> tests;
  std::vector<double> p_values;
  for (std::size_t a = 0; a < comparison.models.size(); ++a) {
    for (std::size_t b = a + 1; b < comparison.models.size(); ++b) {
      const bool a_is_better =
          mean_error_m(comparison.models[a]) <= mean_error_m(comparison.models[b]);
      const ModelResult& better = comparison.models[a_is_better ? a : b];
      const ModelResult& worse = comparison.models[a_is_better ? b : a];
      std::vector<double> differences = run_means(worse);
      const std::vector<double> subtracted = run_means(better);
      for (std::size_t i = 0; i < differences.size(); ++i) differences[i] -= subtracted[i];
      tests.push_back({better.model, worse.model, statistics::mean(differences),
                       statistics::bootstrap_mean(differences, 0.95, kBootstrapSeed), 1.0, false});
      p_values.push_back(statistics::wilcoxon_signed_rank(differences));
    }
  }
  const std::vector<double> adjusted = statistics::holm(p_values);
  for (std::size_t i = 0; i < tests.size(); ++i) {
    tests[i].p = adjusted[i];
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
  const std::size_t seeds = best->runs.size();
  std::string sentence = best->model + " has the lowest mean error, " +
                         metres(mean_error_m(*best)) + " over " + std::to_string(seeds) +
                         (seeds == 1 ? " seed" : " seeds");
  if (!beaten.empty()) sentence += "; significantly below " + beaten;
  if (!alike.empty()) {
    sentence += "; equal for practical purposes, less than half a cell apart: " + alike;
  }
  if (!tied.empty()) sentence += "; no significant difference to " + tied;
  if (beaten.empty()) sentence += "; no difference that matters was shown";
  sentence += ".";
  // With fewer than six pairs no signed-rank test can reach 5%, whatever the data say.
  if (seeds < 6) {
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
                    {"ci95_m", {test.ci95_m.low, test.ci95_m.high}},
                    {"p_holm", test.p},
                    {"significant", test.significant}});
  }
  return {{"log", comparison.log},
          {"train", comparison.train_s},
          {"test", comparison.test_s},
          {"seeds", comparison.models.empty() ? 0 : comparison.models.front().runs.size()},
          {"truth", comparison.truth == TruthKind::kGiven ? "given" : "joint trajectory"},
          {"models", models},
          {"wins", wins},
          {"verdict", verdict(comparison, tests)}};
}

}  // namespace strata::pipeline
