// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/comparison_figures.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "tools/pipeline/comparison_tables.hpp"
#include "tools/report/map_picture.hpp"

namespace strata::pipeline {
namespace {

using report::Color;
using report::fixed;
using report::HtmlReport;
using report::LinePlot;
using report::Series;

constexpr int kMapPixels = 900;
constexpr Color kDynamic{213, 94, 0};
constexpr Color kOutline{0, 114, 178};
constexpr Color kPlace{213, 94, 0};
/// The last percent would stretch an axis until nothing else can be seen; the tables tell of it.
constexpr double kShownShare = 0.99;

std::vector<double> sorted_errors(const ModelResult& model) {
  std::vector<double> all;
  for (const ModelRun& run : model.runs) {
    for (const ScanError& error : run.errors) all.push_back(error.error_m);
  }
  std::sort(all.begin(), all.end());
  return all;
}

LinePlot errors_over_time(const Comparison& comparison) {
  LinePlot plot{.title = "Localization error over time (first drive, first seed)",
                .x_label = "time since the test part began [s]",
                .y_label = "error [m]",
                .from_zero = true};
  for (const ModelResult& model : comparison.models) {
    Series line{model.model, {}, {}};
    const auto& first = model.runs.front().errors;
    for (const ScanError& error : first) {
      line.x.push_back((error.stamp - first.front().stamp).seconds());
      line.y.push_back(error.error_m);
    }
    plot.series.push_back(std::move(line));
  }
  for (const MetChange& change : comparison.parts.front().changes) {
    plot.events.push_back(
        {change.time_s, change.is_old_state ? "change to an old state" : "change to a new state"});
  }
  return plot;
}

LinePlot error_shares(const Comparison& comparison) {
  LinePlot plot{.title = "Share of scans with at most this error (all drives and seeds)",
                .x_label = "error [m]",
                .y_label = "share of scans",
                .from_zero = true,
                .y_max = 1.0};
  for (const ModelResult& model : comparison.models) {
    const std::vector<double> all = sorted_errors(model);
    Series share{model.model, {}, {}};
    constexpr std::size_t kPoints = 200;
    const auto shown = static_cast<std::size_t>(kShownShare * static_cast<double>(all.size()));
    for (std::size_t i = 0; i < kPoints && shown > 0; ++i) {
      const std::size_t at = i * (shown - 1) / (kPoints - 1);
      share.x.push_back(all[at]);
      share.y.push_back(static_cast<double>(at + 1) / static_cast<double>(all.size()));
    }
    plot.series.push_back(std::move(share));
  }
  return plot;
}

/// Bins grow with the error: a robot that was lost is tens of metres off, and one that was not, a
/// few centimetres.
LinePlot error_histogram(const Comparison& comparison) {
  LinePlot plot{.title = "How often each error occurs (all drives and seeds)",
                .x_label = "error [m]",
                .y_label = "share of scans",
                .from_zero = true,
                .log_x = true};
  constexpr double kMin_m = 1e-3;
  double smallest_m = std::numeric_limits<double>::infinity();
  double largest_m = kMin_m;
  std::vector<std::vector<double>> errors;
  for (const ModelResult& model : comparison.models) {
    errors.push_back(sorted_errors(model));
    if (errors.back().empty()) continue;
    const auto first_percent = errors.back().size() / 100;  // below it, all in the first bin
    smallest_m = std::min(smallest_m, std::max(kMin_m, errors.back()[first_percent]));
    largest_m = std::max(largest_m, errors.back().back());
  }
  smallest_m = std::min(smallest_m, 0.5 * largest_m);
  constexpr std::size_t kBins = 40;
  const double factor = std::pow(largest_m / smallest_m, 1.0 / static_cast<double>(kBins));
  for (std::size_t m = 0; m < errors.size(); ++m) {
    std::vector<double> counts(kBins, 0.0);
    for (const double error_m : errors[m]) {
      const double bin = std::log(std::max(error_m, smallest_m) / smallest_m) / std::log(factor);
      counts[std::min(kBins - 1, static_cast<std::size_t>(bin))] += 1.0;
    }
    Series bars{comparison.models[m].model, {}, {}};
    for (std::size_t b = 0; b < kBins; ++b) {
      const double share = counts[b] / static_cast<double>(errors[m].size());
      for (const std::size_t edge : {b, b + 1}) {
        bars.x.push_back(smallest_m * std::pow(factor, static_cast<double>(edge)));
        bars.y.push_back(share);
      }
    }
    plot.series.push_back(std::move(bars));
  }
  return plot;
}

LinePlot error_against_bytes(const Comparison& comparison) {
  LinePlot plot{.title = "Error against map size",
                .x_label = "map size [kB]",
                .y_label = "mean error [m]",
                .from_zero = true,
                .points = true,
                .log_x = true};
  for (const ModelResult& model : comparison.models) {
    Series curve{model.model, {}, {}};
    for (const MemoryPoint& point : model.memory) {
      curve.x.push_back(static_cast<double>(point.bytes) / 1024.0);
      curve.y.push_back(statistics::mean(point.run_means_m));
    }
    if (model.memory.empty()) {
      curve.x.push_back(static_cast<double>(model.map_bytes) / 1024.0);
      curve.y.push_back(mean_error_m(model));
    }
    plot.series.push_back(std::move(curve));
  }
  return plot;
}

}  // namespace

void add_errors(const Comparison& comparison, HtmlReport& page) {
  page.heading("Localization error");
  page.plot(
      "error_over_time", errors_over_time(comparison),
      "As figure 4 of Stachniss and Burgard (2005): the error is the weighted mean distance of "
      "all particles from the truth. Dashed: the robot meets a place in another state than it "
      "was last seen in; an old state is one that some earlier visit had seen.");
  page.plot(
      "error_histogram", error_histogram(comparison),
      "Every scan of every run; bins grow with the error, and the first holds what is smaller.");
  page.plot("error_distribution", error_shares(comparison),
            "Curves further to the left and higher are better; each ends at its 99th "
            "percentile.");
  page.plot("error_against_bytes", error_against_bytes(comparison),
            "Lower and further left is better. Sizes are a byte a cell of each grid, and the state "
            "of the timescale levels. Each line is one model learned in ever less memory, with the "
            "first seeds; the axis counts in powers of ten.");
  add_equal_memory(comparison, page);
}

void add_maps(const LearnResult& learned, HtmlReport& page) {
  page.heading("Maps: all beams, and static beams only");
  const slam::SlamResult& slam = learned.slam;
  const CellRect rect =
      report::known_rect(slam.occupancy).united(report::known_rect(slam.filtered));
  report::MapPicture raw = report::draw_map(slam.occupancy, rect, kMapPixels);
  report::MapPicture filtered = report::draw_map(slam.filtered, rect, kMapPixels);
  page.before_after("maps", raw.image, filtered.image, "the map from all beams",
                    "the map after the beam filter", "What was learned:");
  report::mark_dynamic_beams(raw, slam.scans, kDynamic);
  page.picture(
      "dynamic_beams", raw.image, "The map from all beams with the ends of dynamic beams in orange",
      fixed(100.0 * slam.dynamic_fraction, 1) + "% of the hits were judged dynamic (orange).");
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

namespace {

/// The names of its pictures begin with `prefix`.
void add_submaps(const patch::PatchMap& map, const std::vector<double>& places,
                 const std::string& prefix, HtmlReport& page) {
  report::MapPicture overview =
      report::draw_map(map.base, report::known_rect(map.base), kMapPixels);
  report::mark_submaps(overview, map, kOutline);
  std::vector<Eigen::Vector2d> points_m;
  for (std::size_t i = 0; i + 1 < places.size(); i += 2) {
    points_m.emplace_back(places[i], places[i + 1]);
  }
  report::mark_points(overview, points_m, kPlace);
  const std::string count = std::to_string(map.submaps.size());
  page.picture(prefix + "patch_map", overview.image,
               "The filtered map with the sub-maps outlined in blue",
               count + (map.submaps.size() == 1 ? " sub-map (blue)" : " sub-maps (blue)") +
                   (places.empty() ? "." : ", places in red."));
  for (const patch::Submap& submap : map.submaps) {
    std::string caption = "Sub-map " + std::to_string(submap.id) + ", " +
                          std::to_string(submap.sequences.size()) + " sequences. Shares:";
    for (const patch::Configuration& configuration : submap.configurations) {
      caption += " " + fixed(100.0 * configuration.prior, 0) + "%";
    }
    page.picture(prefix + "submap_" + std::to_string(submap.id), report::draw_submap(submap, 4),
                 "The configurations of sub-map " + std::to_string(submap.id) + " side by side",
                 caption + ".");
  }
}

}  // namespace

void add_patches(const LearnResult& learned, HtmlReport& page) {
  const patch::PatchMap& map = learned.patches;
  page.heading("Patch map: places that change, and the states they take");
  if (map.submaps.empty()) {
    page.paragraph(
        "No place contradicted itself between visits: the patch map has no sub-map and "
        "equals the filtered map.");
    return;
  }
  add_submaps(map, {}, "", page);
  if (!learned.place_patches) return;
  page.heading("The same by places: patch_places");
  page.paragraph(
      "What changes nearest to the same place of the topology is one sub-map, instead of what sees "
      "each other.");
  add_submaps(*learned.place_patches, learned.places, "places_", page);
}

}  // namespace strata::pipeline
