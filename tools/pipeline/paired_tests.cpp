// SPDX-License-Identifier: Apache-2.0
/// Is it more than chance, and how to say so.
#include <algorithm>
#include <cmath>
#include <sstream>

#include "tools/pipeline/comparison.hpp"
#include "tools/pipeline/over_runs.hpp"

namespace strata::pipeline {
namespace {

/// Half a cell of the default map: smaller differences are real at most in the statistical sense.
constexpr double kMinThatMatters_m = 0.025;

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

std::string metres(double value) {
  std::ostringstream out;
  out.setf(std::ios::fixed);
  out.precision(3);
  out << value << " m";
  return out.str();
}

std::size_t lost_runs(const ModelResult& model) {
  return static_cast<std::size_t>(std::count_if(
      model.runs.begin(), model.runs.end(), [](const ModelRun& run) { return run.metrics.lost; }));
}

/// Of the models that got lost more often than the best one, beyond chance: a mean error can hide
/// it.
std::string lost_more_often(const Comparison& comparison, const ModelResult& best,
                            const std::vector<PairedTest>& tests) {
  std::string sentence;
  for (const PairedTest& test : tests) {
    if (test.better != best.model || test.p_lost >= kAlpha) continue;
    if (test.lost_only_worse <= test.lost_only_better) continue;
    const auto worse =
        std::find_if(comparison.models.begin(), comparison.models.end(),
                     [&](const ModelResult& model) { return model.model == test.worse; });
    sentence += " " + test.worse + " got lost in " + std::to_string(lost_runs(*worse)) + " of " +
                std::to_string(worse->runs.size()) + " runs, " + best.model + " in " +
                std::to_string(lost_runs(best)) + ": more than chance.";
  }
  return sentence;
}

}  // namespace

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
    const bool matters = significant && test->mean_difference_m >= kMinThatMatters_m;
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
  const std::string lost_more = lost_more_often(comparison, *best, tests);
  if (beaten.empty()) {
    sentence += lost_more.empty() ? "; no difference that matters was shown"
                                  : "; no difference of the mean error that matters was shown";
  }
  sentence += "." + lost_more;
  // The lowest error is no praise when it is that of a robot that got lost.
  const std::size_t lost = lost_runs(*best);
  if (lost > 0 && 2 * lost >= units) {
    sentence += " Even it was lost in " + std::to_string(lost) + " of " + std::to_string(units) +
                " runs: above 1 m for 5 s or longer.";
  }
  // The least p that a signed-rank test can reach, times the pairs that Holm's correction counts.
  const double min_p = std::ldexp(2.0, -static_cast<int>(units)) *
                       static_cast<double>(std::max<std::size_t>(1, tests.size()));
  if (min_p >= kAlpha) {
    sentence += " With so few seeds no difference can be significant; use --seeds 20 to decide.";
  }
  return sentence;
}

}  // namespace strata::pipeline
