// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/comparison_report.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "tools/report/html_report.hpp"
#include "tools/report/map_picture.hpp"

namespace strata::pipeline {
namespace {

using report::Color;
using report::HtmlReport;
using report::LinePlot;
using report::Series;

constexpr int kMapPixels = 900;
constexpr Color kDynamic{213, 94, 0};
constexpr Color kOutline{0, 114, 178};

std::string fixed(double value, int digits) {
  std::ostringstream out;
  out.setf(std::ios::fixed);
  out.precision(digits);
  out << value;
  return out.str();
}

void add_tables(const Comparison& comparison, const std::vector<PairedTest>& tests,
                HtmlReport& page) {
  report::Table table;
  table.header = {"model",     "mean error",     "95% interval",     "95th percentile", "failures",
                  "lost runs", "log p per beam", "prediction error", "map size"};
  table.caption =
      "Errors in metres: mean over seeds of each run's weighted mean particle distance. "
      "Failures: share of scans further than 0.5 m from the truth after convergence.";
  const nlohmann::json json = to_json(comparison, tests);
  for (const ModelResult& model : comparison.models) {
    const nlohmann::json& m = json["models"][model.model];
    const ScanPrediction prediction = pool_predictions(model, &PredictionScore::overall);
    const bool predicted = prediction.beams > 0;
    table.rows.push_back(
        {model.model, fixed(m["error_m"]["mean"], 3),
         fixed(m["error_m"]["ci95"][0], 3) + " to " + fixed(m["error_m"]["ci95"][1], 3),
         fixed(m["error_m"]["p95"], 3), fixed(100.0 * mean_failure_rate(model), 1) + "%",
         std::to_string(m["lost_runs"].get<int>()) + " of " + std::to_string(model.runs.size()),
         predicted ? fixed(prediction.log_likelihood_per_beam, 3) : "-",
         predicted ? fixed(prediction.median_abs_error_m, 3) : "-",
         fixed(static_cast<double>(model.map_bytes) / 1024.0, 0) + " kB"});
  }
  page.table(table);
  report::Table pairs;
  pairs.header = {"better", "worse", "difference", "95% interval", "p (Holm)", "significant"};
  pairs.caption = "Paired over seeds: bootstrap interval of the mean difference, Wilcoxon's test.";
  for (const PairedTest& test : tests) {
    pairs.rows.push_back({test.better, test.worse, fixed(test.mean_difference_m, 3),
                          fixed(test.ci95_m.low, 3) + " to " + fixed(test.ci95_m.high, 3),
                          test.p < 1e-4 ? std::string("< 0.0001") : fixed(test.p, 4),
                          test.significant ? "yes" : "no"});
  }
  page.table(pairs);
}

void add_errors(const Comparison& comparison, HtmlReport& page) {
  LinePlot over_time{.title = "Localization error over time (first seed)",
                     .x_label = "time since the test part began [s]",
                     .y_label = "error [m]",
                     .from_zero = true};
  LinePlot shares{.title = "Share of scans with at most this error (all seeds)",
                  .x_label = "error [m]",
                  .y_label = "share of scans",
                  .from_zero = true,
                  .y_max = 1.0};
  for (const ModelResult& model : comparison.models) {
    Series line{model.model, {}, {}};
    const auto& first = model.runs.front().errors;
    for (const ScanError& error : first) {
      line.x.push_back((error.stamp - first.front().stamp).seconds());
      line.y.push_back(error.error_m);
    }
    over_time.series.push_back(std::move(line));
    std::vector<double> all;
    for (const ModelRun& run : model.runs) {
      for (const ScanError& error : run.errors) all.push_back(error.error_m);
    }
    std::sort(all.begin(), all.end());
    Series share{model.model, {}, {}};
    constexpr std::size_t kPoints = 200;
    // The last percent would stretch the axis until nothing else can be seen; the table tells of
    // it.
    const std::size_t shown = all.size() * 99 / 100;
    for (std::size_t i = 0; i < kPoints && shown > 0; ++i) {
      const std::size_t at = i * (shown - 1) / (kPoints - 1);
      share.x.push_back(all[at]);
      share.y.push_back(static_cast<double>(at + 1) / static_cast<double>(all.size()));
    }
    shares.series.push_back(std::move(share));
  }
  page.plot(
      "error_over_time", over_time,
      "As figure 4 of Stachniss and Burgard (2005): the error is the weighted mean distance of "
      "all particles from the truth.");
  page.plot("error_distribution", shares,
            "Curves further to the left and higher are better; each ends at its 99th "
            "percentile.");
}

void add_maps(const CompareOutcome& outcome, HtmlReport& page) {
  const slam::SlamResult& slam = outcome.learned.slam;
  const CellRect rect =
      report::known_rect(slam.occupancy).united(report::known_rect(slam.filtered));
  report::MapPicture raw = report::draw_map(slam.occupancy, rect, kMapPixels);
  report::MapPicture filtered = report::draw_map(slam.filtered, rect, kMapPixels);
  page.before_after("maps", raw.image, filtered.image, "the map from all beams",
                    "the map after the beam filter", "The learning part.");
  report::mark_dynamic_beams(raw, slam.scans, kDynamic);
  page.picture("dynamic_beams", raw.image,
               "The map from all beams with the ends of dynamic beams in orange",
               fixed(100.0 * slam.dynamic_fraction, 1) +
                   "% of the hits were judged dynamic (orange), after " +
                   std::to_string(slam.iterations) + " iterations of EM.");
  if (slam.log_likelihood.size() > 1) {
    LinePlot trace{.title = "Log-likelihood of the data",
                   .x_label = "iteration of EM",
                   .y_label = "log-likelihood [nats]"};
    Series series{"log-likelihood", {}, slam.log_likelihood};
    for (std::size_t i = 0; i < slam.log_likelihood.size(); ++i) {
      series.x.push_back(static_cast<double>(i));
    }
    trace.series.push_back(std::move(series));
    page.plot("em_trace", trace, "As figure 1.8 of the chapter on the beam filter.");
  }
}

void add_patches(const CompareOutcome& outcome, HtmlReport& page) {
  const patch::PatchMap& map = outcome.learned.patches;
  page.heading("Patch map: places that change, and the states they take");
  if (map.submaps.empty()) {
    page.paragraph(
        "No place contradicted itself between visits: the patch map has no sub-map and "
        "equals the filtered map.");
    return;
  }
  report::MapPicture overview =
      report::draw_map(map.base, report::known_rect(map.base), kMapPixels);
  report::mark_submaps(overview, map, kOutline);
  page.picture("patch_map", overview.image, "The filtered map with the sub-maps outlined in blue",
               std::to_string(map.submaps.size()) + " sub-maps (blue).");
  for (const patch::Submap& submap : map.submaps) {
    std::string caption = "Sub-map " + std::to_string(submap.id) + ", " +
                          std::to_string(submap.sequences.size()) + " sequences. Shares:";
    for (const patch::Configuration& configuration : submap.configurations) {
      caption += " " + fixed(100.0 * configuration.prior, 0) + "%";
    }
    page.picture("submap_" + std::to_string(submap.id), report::draw_submap(submap, 4),
                 "The configurations of sub-map " + std::to_string(submap.id) + " side by side",
                 caption + ".");
  }
}

/// The trace with the largest swing of its first configuration says most.
const StateTrace* most_telling(const Comparison& comparison) {
  const StateTrace* best = nullptr;
  double best_swing = 0.0;
  for (const ModelResult& model : comparison.models) {
    for (const StateTrace& trace : model.states) {
      if (trace.probability.size() < 2) continue;
      const auto [low, high] =
          std::minmax_element(trace.probability[0].begin(), trace.probability[0].end());
      if (*high - *low <= best_swing && best != nullptr) continue;
      best_swing = *high - *low;
      best = &trace;
    }
  }
  return best;
}

void add_states(const Comparison& comparison, HtmlReport& page) {
  const StateTrace* trace = most_telling(comparison);
  if (trace == nullptr) return;
  LinePlot plot{
      .title = "Posterior over the configurations of sub-map " + std::to_string(trace->submap),
      .x_label = "time since the test part began [s]",
      .y_label = "probability",
      .from_zero = true,
      .y_max = 1.0};
  for (std::size_t k = 0; k < trace->probability.size(); ++k) {
    plot.series.push_back(
        {"configuration " + std::to_string(k), trace->time_s, trace->probability[k]});
  }
  page.plot("configuration_posterior", plot,
            "As figure 5 of Stachniss and Burgard (2005), first seed; the sub-map whose posterior "
            "moved most.");
}

void add_timescale(const CompareOutcome& outcome, HtmlReport& page) {
  if (!outcome.learned.timescale || outcome.learned.timescale->nodes().empty()) return;
  const auto nodes = outcome.learned.timescale->decode();
  page.heading("Timescale memory: what is here lately, and usually");
  const auto busiest = std::max_element(
      nodes->nodes().begin(), nodes->nodes().end(),
      [](const auto& a, const auto& b) { return a.observations < b.observations; });
  const auto node = static_cast<int>(busiest - nodes->nodes().begin());
  LinePlot plot{.title = "Expected scans at node " + std::to_string(node),
                .x_label = "x in the map [m]",
                .y_label = "y in the map [m]",
                .equal_axes = true,
                .height = 560};
  for (std::size_t level = 0; level < nodes->level_names().size(); ++level) {
    const Scan scan = nodes->expected_scan(static_cast<int>(level), node);
    Series series{nodes->level_names()[level], {}, {}};
    for (std::size_t beam = 0; beam < scan.size(); ++beam) {
      const auto range_m = static_cast<double>(scan.ranges_m[beam]);
      const bool known = std::isfinite(range_m);
      constexpr double kBreak = std::numeric_limits<double>::quiet_NaN();
      const double bearing = scan.bearing_rad(beam);
      series.x.push_back(known ? busiest->position_m.x() + range_m * std::cos(bearing) : kBreak);
      series.y.push_back(known ? busiest->position_m.y() + range_m * std::sin(bearing) : kBreak);
    }
    plot.series.push_back(std::move(series));
  }
  page.plot("node_levels", plot,
            "What each level expects around the node with the most observations; gaps: nothing "
            "within reach, or never seen.");
  for (std::size_t level = 0; level < nodes->level_names().size(); ++level) {
    const std::string& name = nodes->level_names()[level];
    const ReflectionGrid map = nodes->level_map(static_cast<int>(level));
    page.picture("level_" + name, report::draw_map(map, report::known_rect(map), kMapPixels).image,
                 "The map that the level " + name + " expects", "Level " + name + ".");
  }
}

void write_errors(const Comparison& comparison, const std::filesystem::path& path) {
  std::ostringstream out;
  out.precision(9);
  out << "model,part,seed,time_s,error_m,error_rad\n";
  for (const ModelResult& model : comparison.models) {
    for (const ModelRun& run : model.runs) {
      for (const ScanError& error : run.errors) {
        out << model.model << ',' << run.part << ',' << run.seed << ',' << error.stamp.seconds()
            << ',' << error.error_m << ',' << error.error_rad << '\n';
      }
    }
  }
  report::write_file(path, out.str());
}

}  // namespace

void write_report(const CompareOutcome& outcome, const std::string& settings,
                  const std::filesystem::path& folder) {
  const Comparison& comparison = outcome.comparison;
  const std::vector<PairedTest> tests = paired_tests(comparison);
  HtmlReport page(folder, "Which map for this building?");
  page.verdict(verdict(comparison, tests));
  const TestPartInfo& part = comparison.parts.front();
  page.paragraph("Log " + comparison.log + ": learned on " +
                 fixed(part.train_s[1] - part.train_s[0], 0) + " s, localized on " +
                 fixed(part.test_s[1] - part.test_s[0], 0) + " s. " +
                 (comparison.truth == TruthKind::kGiven
                      ? "Errors are against given poses."
                      : "No ground truth was given: errors are against the trajectory that SLAM "
                        "gives to the whole log, a pseudo-truth that shares its sensors."));
  add_tables(comparison, tests, page);
  page.heading("Localization error");
  add_errors(comparison, page);
  page.heading("Maps: all beams, and static beams only");
  add_maps(outcome, page);
  add_patches(outcome, page);
  add_states(comparison, page);
  add_timescale(outcome, page);
  page.heading("Fine print");
  page.details("Every parameter", settings);
  write_errors(comparison, folder / "errors.csv");
  report::write_file(folder / "comparison.json", to_json(comparison, tests).dump(2) + "\n");
  page.write();
}

}  // namespace strata::pipeline
