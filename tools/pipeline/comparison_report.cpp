// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/comparison_report.hpp"

#include <algorithm>
#include <cstddef>
#include <sstream>

#include "tools/pipeline/comparison_figures.hpp"
#include "tools/report/html_report.hpp"

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

void add_model_table(const Comparison& comparison, const json& models, HtmlReport& page) {
  report::Table table;
  table.header = {
      "model",     "mean error",     "95% interval",     "median",   "95th percentile", "failures",
      "lost runs", "log p per beam", "prediction error", "map size", "update [ms]"};
  table.caption =
      "Errors in metres: mean over drives and seeds of each run's weighted mean particle distance. "
      "Failures: share of scans further than 0.5 m from the truth after convergence. Lost: above 1 "
      "m "
      "for 5 s or longer. Log p and prediction error: scans not used in learning, at the true "
      "poses.";
  for (const ModelResult& model : comparison.models) {
    const json& m = models[model.model];
    const json& prediction = m["scan_prediction"];
    table.rows.push_back(
        {model.model, number(m["error_m"]["mean"], 3), interval(m["error_m"]["ci95"], 3),
         number(m["error_m"]["median"], 3), number(m["error_m"]["p95"], 3),
         percent(m["failure_rate"]),
         std::to_string(m["lost_runs"].get<int>()) + " of " + std::to_string(model.runs.size()),
         number(field(prediction, "log_likelihood_per_beam"), 3),
         number(field(prediction, "median_abs_error_m"), 3),
         fixed(static_cast<double>(model.map_bytes) / 1024.0, 0) + " kB",
         number(field(m["update_ms"], "median"), 2)});
  }
  page.table(table);
}

void add_pair_table(const std::vector<PairedTest>& tests, HtmlReport& page) {
  report::Table table;
  table.header = {"better",       "worse",         "difference",  "95% interval",
                  "p (Holm)",     "Cliff's delta", "significant", "lost: only better, only worse",
                  "p lost (Holm)"};
  table.caption =
      "Differences of mean error in metres, paired over drive and seed: bootstrap (BCa) interval "
      "of "
      "the mean difference, Wilcoxon's signed-rank test; lost runs by McNemar's exact test. "
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
  table.header = {"model",        "mean error",     "95% interval",
                  "failures",     "log p per beam", "adapted to",
                  "after scans",  "after [s]",      "recall of old states",
                  "P(true state)"};
  table.caption =
      "Only scans, and beams, that reach places that changed. Adapted: from when on 90% of the "
      "beams "
      "that tell the change are predicted within 0.15 m, in the median; grids stay as learned, "
      "patch "
      "models follow by belief, timescale memories go on learning. Recall: log p per beam over the "
      "first ten scans after an old state came back, less that of the map as it was then.";
  for (const ModelResult& model : comparison.models) {
    const json& m = models[model.model];
    const json& changed = m["where_it_changed"];
    const json& error = changed["error_m"];
    table.rows.push_back(
        {model.model, number(field(error, "mean"), 3),
         error.is_null() ? kNone : interval(error["ci95"], 3), percent(changed["failure_rate"]),
         number(field(changed["scan_prediction"], "log_likelihood_per_beam"), 3),
         std::to_string(m["changes_adapted_to"].get<int>()) + " of " +
             std::to_string(m["changes"].get<int>()),
         number(m["adaptation_scans"], 0), number(m["adaptation_s"], 1),
         number(m["recall_old_state"], 3), number(m["true_state_probability"], 2)});
  }
  page.table(table);
}

/// One row a drive, one column a model; only when there are several.
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

void add_agreement(const Comparison& comparison, const json& models, HtmlReport& page) {
  report::Table table;
  table.header = {"model", "distance between seeds"};
  table.caption =
      "Needs no truth: how far the estimates of the seeds lie from their mean at the same scan, in "
      "metres. Seeds that agree may agree on something wrong; seeds that do not cannot all be "
      "right.";
  for (const ModelResult& model : comparison.models) {
    table.rows.push_back({model.model, number(models[model.model]["seed_spread_m"], 3)});
  }
  page.table(table);
}

void write_errors(const Comparison& comparison, const std::filesystem::path& path) {
  std::ostringstream out;
  out.precision(9);
  out << "model,part,seed,time_s,error_m,error_rad,changed\n";
  for (const ModelResult& model : comparison.models) {
    for (const ModelRun& run : model.runs) {
      for (std::size_t i = 0; i < run.errors.size(); ++i) {
        const ScanError& error = run.errors[i];
        out << model.model << ',' << run.part << ',' << run.seed << ',' << error.stamp.seconds()
            << ',' << error.error_m << ',' << error.error_rad << ','
            << (run.sees_change[i] != 0 ? 1 : 0) << '\n';
      }
    }
  }
  report::write_file(path, out.str());
}

/// A test part that leaves the learned area says little about maps.
std::string warn_of_unmapped(const Comparison& comparison) {
  std::size_t scans = 0;
  std::size_t unmapped = 0;
  for (const TestPartInfo& part : comparison.parts) {
    scans += part.scans;
    unmapped += part.unmapped_scans;
  }
  if (unmapped == 0) return "";
  return " " + std::to_string(unmapped) + " of " + std::to_string(scans) +
         " test scans were taken where nothing had been learned; no map can help there.";
}

std::string describe_job(const Comparison& comparison) {
  const TestPartInfo& part = comparison.parts.front();
  std::string text = comparison.log + ": ";
  if (comparison.parts.size() == 1) {
    text += "learned on " + fixed(part.train_s[1] - part.train_s[0], 0) + " s, localized on " +
            fixed(part.test_s[1] - part.test_s[0], 0) + " s. ";
  } else {
    text += std::to_string(comparison.parts.size()) +
            " drives, each localized in maps that did not learn from it. ";
  }
  return text +
         (comparison.truth == TruthKind::kGiven
              ? "Errors are against given poses."
              : "No ground truth was given: errors are against the trajectory that SLAM gives "
                "to the whole log, a pseudo-truth that shares its sensors.");
}

}  // namespace

void write_report(const CompareOutcome& outcome, const std::string& settings,
                  const std::filesystem::path& folder) {
  const Comparison& comparison = outcome.comparison;
  const std::vector<PairedTest> tests = paired_tests(comparison);
  const json result = to_json(comparison, tests);
  HtmlReport page(folder, "Which map for this building?");
  page.verdict(verdict(comparison, tests));
  page.paragraph(describe_job(comparison) + warn_of_unmapped(comparison));
  add_model_table(comparison, result["models"], page);
  add_pair_table(tests, page);
  add_drives(comparison, page);
  add_changed_places(comparison, result["models"], page);
  add_errors(comparison, page);
  add_maps(outcome, page);
  add_patches(outcome, page);
  add_states(comparison, page);
  add_timescale(outcome, page);
  page.heading("Fine print");
  if (comparison.seeds > 1) add_agreement(comparison, result["models"], page);
  page.details("Every parameter", settings);
  write_errors(comparison, folder / "errors.csv");
  report::write_file(folder / "comparison.json", result.dump(2) + "\n");
  page.write();
}

}  // namespace strata::pipeline
