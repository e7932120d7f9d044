// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/localize_output.hpp"

#include <array>
#include <cstddef>

#include "tools/pipeline/map_fit.hpp"

namespace strata::pipeline {
namespace {

using nlohmann::json;

json summary_json(const ErrorSummary& summary) {
  return {{"mean", summary.mean},
          {"median", summary.median},
          {"p95", summary.p95},
          {"max", summary.max},
          {"rmse", summary.rmse}};
}

/// The shares of the bins of score_json() that were wrong; null where no scan has a truth.
void add_wrong_shares(json& score, std::span<const ScanError> errors) {
  std::array<std::size_t, maps::kScoreBins> scans{};
  std::array<std::size_t, maps::kScoreBins> wrong{};
  for (const ScanError& error : errors) {
    const std::size_t bin = maps::score_bin(error.score);
    ++scans[bin];
    if (error.error_m > kFailureDistance_m) ++wrong[bin];
  }
  for (std::size_t bin = 0; bin < maps::kScoreBins; ++bin) {
    if (scans[bin] == 0) continue;
    score["bins"][bin][3] = static_cast<double>(wrong[bin]) / static_cast<double>(scans[bin]);
  }
}

}  // namespace

void add_errors(json& metrics, std::span<const ScanError> errors,
                const std::optional<Pose2>& map_from_truth) {
  if (!errors.empty()) {
    const LocalizationMetrics values = evaluate_run(errors);
    metrics["error_m"] = summary_json(values.error_m);
    metrics["error_rad"] = summary_json(values.error_rad);
    metrics["failure_rate"] = values.failure_rate;
    metrics["lost"] = values.lost;
    if (values.converged_after_s) metrics["converged_after_s"] = *values.converged_after_s;
  }
  if (map_from_truth) {
    metrics["map_from_truth"] = {map_from_truth->x, map_from_truth->y, map_from_truth->theta};
  }
}

json map_fit_json(const LogFit& fit) {
  json shares{{"scans", fit.scans.size()},
              {"is_explained", fit.scans.empty() ? json(nullptr) : json(fit.is_explained())}};
  for (const auto& [kind, name] : EnumNames<FitState>::values) shares[name] = fit.share(kind);
  return shares;
}

json write_localization(const std::filesystem::path& folder, const LocalizationRun& run,
                        const LocalizeSummary& summary, const LogFit* fit) {
  json metrics = maps::localization_metrics(run, summary.model, summary.seed, summary.particles);
  add_errors(metrics, run.errors, summary.map_from_truth);
  if (!run.refined_errors.empty()) {
    const LocalizationMetrics refined = evaluate_run(run.refined_errors);
    metrics["refined"]["error_m"] = summary_json(refined.error_m);
    metrics["refined"]["error_rad"] = summary_json(refined.error_rad);
  }
  add_wrong_shares(metrics["score"], run.errors);
  if (fit != nullptr) metrics["map_fit"] = map_fit_json(*fit);
  const double duration_s =
      run.trajectory.size() < 2
          ? 0.0
          : (run.trajectory.back().stamp - run.trajectory.front().stamp).seconds();
  const Cost& cost = summary.cost;
  metrics["cost"] = {{"wall_s", cost.wall_s},
                     {"cpu_s", cost.cpu_s},
                     {"real_time_factor", cost.wall_s > 0.0 ? duration_s / cost.wall_s : 0.0},
                     {"peak_rss_mb", cost.peak_rss_mb}};
  maps::write_localization_files(folder, run, metrics);
  return metrics;
}

}  // namespace strata::pipeline
