// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/comparison_report.hpp"

#include <algorithm>
#include <cstddef>
#include <sstream>

#include "components/log/json_text.hpp"
#include "tools/pipeline/comparison_figures.hpp"
#include "tools/pipeline/comparison_replay.hpp"
#include "tools/pipeline/comparison_tables.hpp"
#include "tools/pipeline/drive_replay.hpp"
#include "tools/report/html_report.hpp"

namespace strata::pipeline {
namespace {

using nlohmann::json;
using report::fixed;
using report::HtmlReport;

void write_errors(const Comparison& comparison, const std::filesystem::path& path) {
  std::ostringstream out;
  out.precision(9);
  out << "model,part,seed,time_s,error_m,error_rad,changed\n";
  for (const ModelResult& model : comparison.models) {
    for (const ModelRun& run : model.runs) {
      for (std::size_t i = 0; i < run.errors.size(); ++i) {
        const ScanError& error = run.errors[i];
        out << model.model << ',' << run.part << ',' << run.seed << ','
            << fixed(error.stamp.seconds(), 6) << ',' << error.error_m << ',' << error.error_rad
            << ',' << (run.sees_change[i] != 0 ? 1 : 0) << '\n';
      }
    }
  }
  report::write_file(path, out.str());
}

/// The held-out fit scan by scan.
void write_predictions(const Comparison& comparison, const std::filesystem::path& path) {
  std::ostringstream out;
  out.precision(9);
  out << "model,part,time_s,log_likelihood,beams\n";
  for (const ModelResult& model : comparison.models) {
    for (std::size_t p = 0; p < model.scores.size(); ++p) {
      for (const ScanFit& fit : model.scores[p].series) {
        out << model.model << ',' << p << ',' << fit.time_s << ',' << fit.nats << ',' << fit.beams
            << '\n';
      }
    }
  }
  report::write_file(path, out.str());
}

}  // namespace

void write_series(const Comparison& comparison, const std::filesystem::path& folder) {
  write_errors(comparison, folder / "errors.csv");
  write_predictions(comparison, folder / "predictions.csv");
}

namespace {

constexpr const char* kPlayDrive = "Play the drive: every model's first run, side by side";
constexpr const char* kPlayFirstDrive =
    "Play the first drive: every model's first run in it, side by side";

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

MapFigures draw_maps(const LearnResult& learned, const maps::Maps& maps,
                     const std::filesystem::path& folder, report::Drawings* drawings) {
  HtmlReport grids(folder, "", drawings);
  add_maps(learned, grids);
  add_patches(learned, grids);
  HtmlReport timescale(folder, "", drawings);
  add_timescale(learned, maps, timescale);
  return {grids.body(), timescale.body()};
}

void write_report(const CompareOutcome& outcome, const std::string& settings,
                  const std::filesystem::path& folder, report::Drawings* drawings) {
  report::draw(drawings, folder / kReplayPage, [&] {
    write_comparison_replay(outcome.comparison, outcome.maps, outcome.drive, folder);
  });
  write_report(outcome.comparison, draw_maps(outcome.learned, outcome.maps, folder, drawings),
               settings, folder, drawings);
}

void write_report(const Comparison& comparison, const MapFigures& figures,
                  const std::string& settings, const std::filesystem::path& folder,
                  report::Drawings* drawings) {
  const std::vector<PairedTest> tests = paired_tests(comparison);
  const json result = to_json(comparison, tests);
  HtmlReport page(folder, "Which map for this building?", drawings);
  page.verdict(verdict(comparison, tests));
  page.paragraph(describe_job(comparison) + warn_of_unmapped(comparison));
  if (std::filesystem::exists(folder / kReplayPage)) {
    page.link(kReplayPage, comparison.parts.size() > 1 ? kPlayFirstDrive : kPlayDrive);
  }
  add_model_table(comparison, result["models"], page);
  add_pairs(comparison, tests, page);
  add_drives(comparison, page);
  add_changed_places(comparison, result["models"], page);
  add_errors(comparison, page);
  page.append(figures.grids_and_patches);
  add_states(comparison, page);
  page.append(figures.timescale);
  finish_report(comparison, result, settings, folder, page);
}

void finish_report(const Comparison& comparison, const nlohmann::json& result,
                   const std::string& settings, const std::filesystem::path& folder,
                   report::HtmlReport& page) {
  page.heading("Fine print");
  add_more_measures(comparison, result["models"], page);
  add_robustness(comparison, result["models"], page);
  add_without_truth(comparison, result["models"], page);
  page.details("Every parameter", settings);
  write_series(comparison, folder);
  report::write_file(folder / "comparison.json", log::json_text(result));
  page.write();
}

}  // namespace strata::pipeline
