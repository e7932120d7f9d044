// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/comparison_tables.hpp"

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "tools/pipeline/comparison_cells.hpp"
#include "tools/pipeline/equal_memory.hpp"

namespace strata::pipeline {
using nlohmann::json;
using report::fixed;
using report::HtmlReport;

void add_model_table(const Comparison& comparison, const json& models, HtmlReport& page) {
  report::Table table;
  const bool is_pseudo = comparison.truth == TruthKind::kJointTrajectory;
  table.header = {"model",          is_pseudo ? "mean error (pseudo-truth)" : "mean error",
                  "95% interval",   "failures",
                  "lost runs",      "log p per beam",
                  "95% interval",   "map size",
                  "update p99 [ms]"};
  table.caption = "Errors in metres, over all drives and seeds.";
  table.terms = {
      {"mean error",
       "distance of the particles from the truth, by their weights: the mean of each run, then of "
       "all runs"},
      {"95% interval",
       "confidence interval: were everything repeated, 19 of 20 such intervals would hold the true "
       "mean; that of log p comes from the drive itself, by blocks of 30 s"},
      {"failures",
       "failure rate: share of the scans further than 0.5 m from the truth, once the particles "
       "have converged"},
      {"lost runs", "runs whose error stayed above 1 m for 5 s or longer"},
      {"log p per beam",
       "how well scans that were not learned are expected, as seen from the true poses: higher is "
       "better, and 0.7 more is twice as likely"},
      {"update p99", "99% of the scans were worked in within this time"}};
  const auto cells = [](const ModelResult& model, const json& m) {
    const json& prediction = m["scan_prediction"];
    const json ci = field(prediction, "ci95");
    return CellRow{
        number(m["error_m"]["mean"], 3),
        interval(m["error_m"]["ci95"], 3),
        percent(m["failure_rate"]),
        std::to_string(m["lost_runs"].get<int>()) + " of " + std::to_string(model.runs.size()),
        number(field(prediction, "log_likelihood_per_beam"), 3),
        ci.is_null() ? kNoValue : interval(ci, 3),
        kilobytes(model.map_bytes),
        number(field(m["update_ms"], "p99"), 1)};
  };
  add_model_rows(std::move(table), comparison, models, cells, page);
}

void add_changed_places(const Comparison& comparison, const json& models, HtmlReport& page) {
  std::size_t scans = 0;
  std::size_t changes = 0;
  for (const TestPartInfo& part : comparison.parts) {
    scans += part.changed_scans;
    changes += part.changes.size();
  }
  page.heading("Where the building changed");
  if (scans == 0) {
    page.paragraph("No test scan sees a place that was found in different states.");
    return;
  }
  page.paragraph(std::to_string(scans) +
                 " test scans see a place that was found in different "
                 "states, and the robot met " +
                 std::to_string(changes) + " changes.");
  report::Table table;
  table.header = {"model",        "mean error", "95% interval",   "failures",
                  "old state",    "new state",  "log p per beam", "adapted to",
                  "after scans",  "after [s]",  "half changed",   "recall of old states",
                  "P(true state)"};
  table.caption = "Errors in metres, only of scans, and beams, that reach places that changed.";
  table.terms = {
      {"failures", "share of these scans further than 0.5 m from the truth"},
      {"old state, new state",
       "mean error in scans that show a state that came back, and one never seen before"},
      {"log p per beam", "how well these beams are expected: higher is better"},
      {"adapted to",
       "changes from which on 90% of the beams that tell them were predicted within 0.15 m; grids "
       "stay as learned, patch models follow by belief, timescale memories go on learning"},
      {"after", "how long that took, in the median over all changes"},
      {"half changed",
       "share of those scans in which the change was expected partly as before and partly as it is "
       "now"},
      {"recall of old states",
       "log p per beam over the first ten scans after an old state came back, less that of the map "
       "as it was then"},
      {"P(true state)", "what was believed then of the configurations that show what came back"}};
  const auto cells = [](const ModelResult& /*model*/, const json& m) {
    const json& changed = m["where_it_changed"];
    const json& error = changed["error_m"];
    return CellRow{number(field(error, "mean"), 3),
                   error.is_null() ? kNoValue : interval(error["ci95"], 3),
                   percent(changed["failure_rate"]),
                   number(changed["old_state_error_m"], 3),
                   number(changed["new_state_error_m"], 3),
                   number(field(changed["scan_prediction"], "log_likelihood_per_beam"), 3),
                   std::to_string(m["changes_adapted_to"].get<int>()) + " of " +
                       std::to_string(m["changes"].get<int>()),
                   number(m["adaptation_scans"], 0),
                   number(m["adaptation_s"], 1),
                   percent(m["half_changed_share"]),
                   number(m["recall_old_state"], 3),
                   number(m["true_state_probability"], 2)};
  };
  add_model_rows(std::move(table), comparison, models, cells, page);
}

void add_drives(const Comparison& comparison, HtmlReport& page) {
  if (comparison.parts.size() < 2) return;
  report::Table table;
  table.header = {"drive", "scans"};
  table.caption = "Mean error of each drive, in metres.";
  for (const ModelResult& model : comparison.models) table.header.push_back(model.model);
  for (std::size_t p = 0; p < comparison.parts.size(); ++p) {
    const TestPartInfo& part = comparison.parts[p];
    std::vector<std::string> row{part.name, std::to_string(part.scans)};
    for (const ModelResult& model : comparison.models) {
      double sum = 0.0;
      double count = 0.0;
      for (const ModelRun& run : model.runs) {
        if (run.part != p) continue;
        sum += run.metrics.error_m.mean;
        count += 1.0;
      }
      row.push_back(fixed(sum / count, 3));
    }
    table.rows.push_back(std::move(row));
  }
  page.table(table);
}

void add_equal_memory(const Comparison& comparison, HtmlReport& page) {
  const std::vector<MemoryBudget> budgets = equal_memory(comparison);
  if (budgets.empty()) return;
  report::Table table;
  table.header = {"model"};
  table.caption =
      "Mean error in metres when every map must fit in as many bytes as stored. Every model was "
      "learned again from the same scans at half and a quarter of its resolution (timescale: of "
      "its angle bins, samples and nodes a metre); here stands the largest that fits, with its "
      "setting, over " +
      std::to_string(comparison.models.front().memory.front().run_means_m.size()) +
      " runs. Few runs: see the intervals in comparison.json before making much of it.";
  for (const MemoryBudget& budget : budgets) {
    table.header.push_back("in " + kilobytes(budget.bytes));
  }
  for (std::size_t m = 0; m < comparison.models.size(); ++m) {
    if (comparison.models[m].memory.empty()) continue;
    std::vector<std::string> row{comparison.models[m].model};
    for (const MemoryBudget& budget : budgets) {
      const MemoryPoint* point = budget.points[m];
      row.push_back(point == nullptr ? "does not fit"
                                     : fixed(statistics::mean(point->run_means_m), 3) + " (" +
                                           point->setting + ")");
    }
    table.rows.push_back(std::move(row));
  }
  page.table(table);
}

}  // namespace strata::pipeline
