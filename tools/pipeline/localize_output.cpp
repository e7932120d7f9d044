// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/localize_output.hpp"

#include <algorithm>
#include <sstream>

#include "core/base/config.hpp"
#include "tools/report/image.hpp"

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

std::string states_csv(const std::vector<StateRow>& rows) {
  std::ostringstream out;
  out.setf(std::ios::fixed);
  out.precision(9);
  out << "time,submap,configuration,probability\n";
  for (const StateRow& row : rows) {
    out << row.stamp.seconds() << ',' << row.submap << ',' << row.configuration << ','
        << row.probability << '\n';
  }
  return out.str();
}

json health_json(const std::vector<localization::HealthState>& health) {
  json shares = json::object();
  for (const auto& [state, name] : EnumNames<localization::HealthState>::values) {
    const auto count = std::count(health.begin(), health.end(), state);
    shares[name] =
        health.empty() ? 0.0 : static_cast<double>(count) / static_cast<double>(health.size());
  }
  return shares;
}

}  // namespace

json write_localization(const std::filesystem::path& folder, const LocalizationRun& run,
                        const LocalizeSummary& summary) {
  json metrics = {{"model", summary.model},
                  {"seed", summary.seed},
                  {"particles", summary.particles},
                  {"scans", run.trajectory.size()},
                  {"unusable_scans", run.unusable_scans},
                  {"health", health_json(run.health)},
                  {"error_m", nullptr},
                  {"error_rad", nullptr},
                  {"failure_rate", nullptr},
                  {"lost", nullptr},
                  {"converged_after_s", nullptr}};
  if (!run.errors.empty()) {
    const LocalizationMetrics values = evaluate_run(run.errors);
    metrics["error_m"] = summary_json(values.error_m);
    metrics["error_rad"] = summary_json(values.error_rad);
    metrics["failure_rate"] = values.failure_rate;
    metrics["lost"] = values.lost;
    if (values.converged_after_s) metrics["converged_after_s"] = *values.converged_after_s;
  }
  if (summary.map_from_truth) {
    const Pose2& pose = *summary.map_from_truth;
    metrics["map_from_truth"] = {pose.x, pose.y, pose.theta};
  }
  const double duration_s =
      run.trajectory.size() < 2
          ? 0.0
          : (run.trajectory.back().stamp - run.trajectory.front().stamp).seconds();
  const Cost& cost = summary.cost;
  metrics["cost"] = {{"wall_s", cost.wall_s},
                     {"cpu_s", cost.cpu_s},
                     {"real_time_factor", cost.wall_s > 0.0 ? duration_s / cost.wall_s : 0.0},
                     {"peak_rss_mb", cost.peak_rss_mb}};
  log::write_trajectory(folder / "trajectory.tum", run.trajectory);
  report::write_file(folder / "states.csv", states_csv(run.states));
  report::write_file(folder / "metrics.json", metrics.dump(2) + "\n");
  return metrics;
}

}  // namespace strata::pipeline
