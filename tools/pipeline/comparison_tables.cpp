// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/comparison_tables.hpp"

#include <cstddef>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "tools/pipeline/equal_memory.hpp"

namespace strata::pipeline {
namespace {

using nlohmann::json;
using report::fixed;
using report::HtmlReport;

constexpr const char* kNone = "-";

std::string number(const json& value, int digits) {
  return value.is_null() ? kNone : fixed(value.get<double>(), digits);
}

std::string interval(const json& ci, int digits) {
  return fixed(ci[0].get<double>(), digits) + " to " + fixed(ci[1].get<double>(), digits);
}

std::string percent(const json& share) {
  return share.is_null() ? kNone : fixed(100.0 * share.get<double>(), 1) + "%";
}

std::string p_value(double p) { return p < 1e-4 ? "< 0.0001" : fixed(p, 4); }

/// A field of an object that may be null.
json field(const json& object, const char* key) {
  return object.is_null() ? json(nullptr) : object[key];
}

std::string kilobytes(std::size_t bytes) {
  return fixed(static_cast<double>(bytes) / 1024.0, 0) + " kB";
}

using Row = std::vector<std::string>;

/// The table with a row a model: its name, then what `cells` says of it and its figures.
template <typename Cells>
void add_table(report::Table table, const Comparison& comparison, const json& models, Cells cells,
               HtmlReport& page) {
  for (const ModelResult& model : comparison.models) {
    Row row = cells(model, models[model.model]);
    row.insert(row.begin(), model.model);
    table.rows.push_back(std::move(row));
  }
  page.table(table);
}

}  // namespace

void add_model_table(const Comparison& comparison, const json& models, HtmlReport& page) {
  report::Table table;
  const bool is_pseudo = comparison.truth == TruthKind::kJointTrajectory;
  table.header = {"model",          is_pseudo ? "mean error (pseudo-truth)" : "mean error",
                  "95% interval",   "failures",
                  "lost runs",      "log p per beam",
                  "95% interval",   "map size",
                  "update p99 [ms]"};
  table.caption =
      "Errors in metres: mean over drives and seeds of each run's weighted mean particle distance. "
      "Failures: share of scans further than 0.5 m from the truth after convergence. Lost: above 1 "
      "m for 5 s or longer. Log p: scans not used in learning, as seen from the true poses; its "
      "interval comes from the drive itself, by blocks of 30 s. Update: 99% "
      "of the scans took less.";
  const auto cells = [](const ModelResult& model, const json& m) {
    const json& prediction = m["scan_prediction"];
    const json ci = field(prediction, "ci95");
    return Row{
        number(m["error_m"]["mean"], 3),
        interval(m["error_m"]["ci95"], 3),
        percent(m["failure_rate"]),
        std::to_string(m["lost_runs"].get<int>()) + " of " + std::to_string(model.runs.size()),
        number(field(prediction, "log_likelihood_per_beam"), 3),
        ci.is_null() ? kNone : interval(ci, 3),
        kilobytes(model.map_bytes),
        number(field(m["update_ms"], "p99"), 1)};
  };
  add_table(std::move(table), comparison, models, cells, page);
}

void add_pair_table(const std::vector<PairedTest>& tests, HtmlReport& page) {
  report::Table table;
  table.header = {"better",       "worse",         "difference",  "95% interval",
                  "p (Holm)",     "Cliff's delta", "significant", "lost: only better, only worse",
                  "p lost (Holm)"};
  table.caption =
      "Differences of mean error in metres, paired over drive and seed: bootstrap (BCa) interval "
      "of the mean difference, Wilcoxon's signed-rank test; lost runs by McNemar's exact test. "
      "Significant: both the interval and the test say so.";
  for (const PairedTest& test : tests) {
    table.rows.push_back(
        {test.better, test.worse, fixed(test.mean_difference_m, 3),
         fixed(test.ci95_m.low, 3) + " to " + fixed(test.ci95_m.high, 3), p_value(test.p),
         fixed(test.cliffs_delta, 2), test.significant ? "yes" : "no difference shown",
         std::to_string(test.lost_only_better) + ", " + std::to_string(test.lost_only_worse),
         p_value(test.p_lost)});
  }
  page.table(table);
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
  table.caption =
      "Only scans, and beams, that reach places that changed; old and new state: mean error in "
      "scans that show a state that came back, and one never seen before. Adapted: from when on "
      "90% of the beams that tell the change are predicted within 0.15 m, in the median; grids "
      "stay as learned, patch models follow by belief, timescale memories go on learning. Half "
      "changed: share of those "
      "scans in which the change was expected partly as before and partly as it is now. Recall: "
      "log p per beam over the first ten scans after an old state came back, less that of the map "
      "as it was then.";
  const auto cells = [](const ModelResult& /*model*/, const json& m) {
    const json& changed = m["where_it_changed"];
    const json& error = changed["error_m"];
    return Row{number(field(error, "mean"), 3),
               error.is_null() ? kNone : interval(error["ci95"], 3),
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
  add_table(std::move(table), comparison, models, cells, page);
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

void add_more_measures(const Comparison& comparison, const json& models, HtmlReport& page) {
  report::Table table;
  table.header = {"model",         "median error", "95th percentile", "maximum",
                  "heading [deg]", "recovered",    "after [s]",       "prediction error",
                  "in memory",     "update [ms]",  "query [ms]",      "query p99 [ms]"};
  table.caption =
      "Errors in metres, means over drives and seeds. Recovered: lost runs that came back below "
      "0.5 m for 5 s, and the median of the time it took. Prediction error: median over the beams "
      "of scans not used in learning. In memory: grids, the distances that rays skip by, and the "
      "timescale memory with what was decoded. Update: the median; a scan is skipped while the "
      "robot has hardly moved. Query: to expect the beams of one scan.";
  const auto cells = [](const ModelResult& model, const json& m) {
    const json& error = m["error_m"];
    return Row{number(error["median"], 3),
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
  add_table(std::move(table), comparison, models, cells, page);
}

void add_robustness(const Comparison& comparison, const json& models, HtmlReport& page) {
  report::Table table;
  table.header = {"model",         "false adaptation",   "no path",
                  "blocked paths", "path length varies", "next path differs [m]"};
  table.caption =
      "False adaptation: an obstacle 0.6 m wide is put into the recorded scans for 30 s beside the "
      "robot's way; of the beams through its place afterwards, the share that only the model that "
      "met it predicts wrongly. Planning: shortest ways between places of the drive, asked 15 "
      "times along it in the map as the model knows it then, for a robot of 0.25 m radius; "
      "blocked: through what this drive found occupied. Varies: standard deviation over mean of "
      "the length; "
      "differs: discrete Frechet distance to the path asked for before. Grids do not learn while "
      "they localize, so they can be wrong but not change.";
  const auto cells = [](const ModelResult& /*model*/, const json& m) {
    const json& planning = m["planning"];
    return Row{percent(m["false_adaptation"]), percent(field(planning, "no_path_rate")),
               percent(field(planning, "blocked_path_rate")),
               percent(field(planning, "path_length_cv")), number(field(planning, "frechet_m"), 3)};
  };
  add_table(std::move(table), comparison, models, cells, page);
}

void add_without_truth(const Comparison& comparison, const json& models, HtmlReport& page) {
  report::Table table;
  table.header = {"model", "distance between seeds", "log p per unseen beam", "prediction error"};
  table.caption =
      "Needs no truth. How far the estimates of the seeds lie from their mean at the same scan, in "
      "metres: seeds that agree may agree on something wrong; seeds that do not cannot all be "
      "right. Unseen beams: those that the localizer does not look at, predicted from where it "
      "believed to be (the first three seeds).";
  const auto cells = [](const ModelResult& /*model*/, const json& m) {
    const json& own = m["own_pose_prediction"];
    return Row{number(m["seed_spread_m"], 3), number(field(own, "log_likelihood_per_beam"), 3),
               number(field(own, "median_abs_error_m"), 3)};
  };
  add_table(std::move(table), comparison, models, cells, page);
}

}  // namespace strata::pipeline
