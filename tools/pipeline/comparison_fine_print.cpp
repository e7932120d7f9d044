// SPDX-License-Identifier: Apache-2.0
/// The tables at the end of a comparison's report.
#include <numbers>
#include <string>
#include <utility>

#include "tools/pipeline/comparison_cells.hpp"
#include "tools/pipeline/comparison_tables.hpp"

namespace strata::pipeline {

using nlohmann::json;
using report::fixed;
using report::HtmlReport;

void add_more_measures(const Comparison& comparison, const json& models, HtmlReport& page) {
  report::Table table;
  table.header = {"model",         "median error", "95th percentile", "maximum",
                  "heading [deg]", "recovered",    "after [s]",       "prediction error",
                  "in memory",     "update [ms]",  "query [ms]",      "query p99 [ms]"};
  table.caption = "Errors in metres, means over drives and seeds.";
  table.terms = {
      {"95th percentile", "95% of a run's scans have a smaller error"},
      {"recovered",
       "lost runs that came back below 0.5 m for 5 s, and how long that took, in the median"},
      {"prediction error", "median over the beams of scans not used in learning, in metres"},
      {"in memory",
       "grids, the distances that rays skip by, and the timescale memory with what was decoded"},
      {"update", "time to work in a scan, in the median; skipped while the robot has hardly moved"},
      {"query", "time to expect the beams of one scan; p99: 99% took less"}};
  const auto cells = [](const ModelResult& model, const json& m) {
    const json& error = m["error_m"];
    return CellRow{number(error["median"], 3),
                   number(error["p95"], 3),
                   number(error["max"], 3),
                   fixed(m["error_rad"]["mean"].get<double>() * 180.0 / std::numbers::pi, 2),
                   std::to_string(m["recovered_runs"].get<int>()) + " of " +
                       std::to_string(m["lost_runs"].get<int>()),
                   number(m["recovery_s"], 1),
                   number(field(m["scan_prediction"], "median_abs_error_m"), 3),
                   kilobytes(model.resident_bytes),
                   number(field(m["update_ms"], "median"), 2),
                   number(field(m["query_ms"], "median"), 3),
                   number(field(m["query_ms"], "p99"), 3)};
  };
  add_model_rows(std::move(table), comparison, models, cells, page);
}

void add_robustness(const Comparison& comparison, const json& models, HtmlReport& page) {
  report::Table table;
  table.header = {"model",         "false adaptation",   "no path",
                  "blocked paths", "path length varies", "next path differs [m]"};
  table.caption =
      "What passing obstacles leave behind, and ways planned in the map as the model knows it, "
      "asked for 15 times along the drive, for a robot of 0.25 m radius.";
  table.terms = {
      {"false adaptation",
       "an obstacle 0.6 m wide is put into the recorded scans for 30 s beside the robot's way; of "
       "the beams through its place afterwards, the share that only the model that met it predicts "
       "wrongly"},
      {"no path, blocked paths",
       "share of the ways that were not found, and that lead through what this drive found "
       "occupied"},
      {"path length varies", "standard deviation over mean of the length of one way"},
      {"next path differs",
       "discrete Frechet distance to the path asked for before: the farthest that the two come "
       "apart"},
      {"grids", "do not learn while they localize, so they can be wrong but not change"}};
  const auto cells = [](const ModelResult& /*model*/, const json& m) {
    const json& planning = m["planning"];
    return CellRow{percent(m["false_adaptation"]), percent(field(planning, "no_path_rate")),
                   percent(field(planning, "blocked_path_rate")),
                   percent(field(planning, "path_length_cv")),
                   number(field(planning, "frechet_m"), 3)};
  };
  add_model_rows(std::move(table), comparison, models, cells, page);
}

void add_without_truth(const Comparison& comparison, const json& models, HtmlReport& page) {
  report::Table table;
  table.header = {"model", "distance between seeds", "log p per unseen beam", "prediction error"};
  table.caption = "What can be said without any truth.";
  table.terms = {
      {"distance between seeds",
       "how far the seeds' estimates lie from their mean at the same scan, in metres: seeds that "
       "agree may agree on something wrong; seeds that do not cannot all be right"},
      {"log p per unseen beam, prediction error",
       "of beams that the localizer does not look at, predicted from where it believed to be (the "
       "first three seeds)"}};
  const auto cells = [](const ModelResult& /*model*/, const json& m) {
    const json& own = m["own_pose_prediction"];
    return CellRow{number(m["seed_spread_m"], 3), number(field(own, "log_likelihood_per_beam"), 3),
                   number(field(own, "median_abs_error_m"), 3)};
  };
  add_model_rows(std::move(table), comparison, models, cells, page);
}

}  // namespace strata::pipeline
