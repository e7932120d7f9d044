// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/real_scans_report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "core/base/error.hpp"
#include "tools/laboratory/experiments/decoder_table.hpp"
#include "tools/report/plot.hpp"

namespace strata::experiments {
namespace {

using report::LinePlot;
using report::Series;

/// As the simulated experiment's robot is taken for.
const Pose2 kWrong{-0.3, 0.2, 0.1};
/// Of a SICK LMS, by its data sheet.
constexpr double kScannerNoise_m = 0.01;

void figure_6(const TwoStates& states, const PlaceFigures& figures,
              const std::filesystem::path& out) {
  LinePlot plot{.title = "Real scans: the place changes",
                .x_label = "scans since",
                .y_label = "share of the object shown (first seed)"};
  std::printf(
      "figure 6: | decoder | shown whole after [scans] | share of new samples then | mixed scans "
      "| never |\n");
  for (const NamedDecoder& decoder : paper_decoders()) {
    const SwitchResult result = switch_states(states, decoder, figures);
    std::printf("| %s | %.1f | %.2f (%.2f to %.2f) | %.1f of 60 | %d of %d |\n",
                decoder.name.c_str(), result.first_scan, result.share, result.min_share,
                result.greatest_share, result.mixed, result.never, figures.seeds);
    Series series{decoder.name, {}, result.shown};
    for (std::size_t t = 0; t < result.shown.size(); ++t) {
      series.x.push_back(static_cast<double>(t + 1));
    }
    plot.series.push_back(std::move(series));
  }
  report::save_png(plot, out / "place_figure_6.png");
}

/// Angle bins from the object's first to one of its bins, the way it lies.
int bins_along(const TwoStates& states, std::size_t bin, const memory::PolarBins& bins) {
  const int along = static_cast<int>(bin) - static_cast<int>(states.bins.front());
  return along < 0 ? along + bins.angle_bins : along;
}

/// Ranges about the object, in order of the angle.
Series around(const std::string& name, const std::vector<float>& range_m, const TwoStates& states,
              const memory::PolarBins& bins) {
  constexpr int kAside = 15;
  Series series{name, {}, {}};
  const int first = static_cast<int>(states.bins.front());
  const int width = bins_along(states, states.bins.back(), bins);
  for (int i = -kAside; i <= width + kAside; ++i) {
    const int bin = ((first + i) % bins.angle_bins + bins.angle_bins) % bins.angle_bins;
    const float range = range_m[static_cast<std::size_t>(bin)];
    series.x.push_back(360.0 * (first + i) / bins.angle_bins);
    series.y.push_back(std::isnan(range) ? std::numeric_limits<double>::quiet_NaN()
                                         : std::min(static_cast<double>(range), bins.max_range_m));
  }
  return series;
}

void figure_7(const TwoStates& states, const PlaceFigures& figures,
              const std::filesystem::path& out) {
  LinePlot plot{.title = "Real scans: the far half is hidden after the change",
                .x_label = "bearing from the node [degrees]",
                .y_label = "range [m]",
                .from_zero = true};
  plot.series.push_back(around("before", states.before_m, states, figures.bins));
  plot.series.push_back(around("after", states.after_m, states, figures.bins));
  std::printf("figure 7: | decoder | seeds in which the hidden half is completed |\n");
  for (const NamedDecoder& decoder : paper_decoders()) {
    const CompletionResult result = complete_half(states, decoder, figures);
    std::printf("| %s | %d of %d |\n", decoder.name.c_str(), result.complete, figures.seeds);
    if (decoder.name == "scene" || decoder.name == "median of each bin") {
      plot.series.push_back(around(decoder.name, result.decoded_m, states, figures.bins));
    }
  }
  const int hidden_from = static_cast<int>(states.bins.front()) +
                          bins_along(states, states.bins[states.bins.size() / 2], figures.bins);
  plot.events.push_back({360.0 * hidden_from / figures.bins.angle_bins, "hidden from here on"});
  report::save_png(plot, out / "place_figure_7.png");
}

/// Prints a table; returns the curves.
std::vector<Series> wrong_bins_by_share(const TwoStates& poses, const PlaceFigures& figures) {
  std::printf("figure 8, %zu bins: | decoder | wrong bins at 10%%, 20%%, 30%%, 40%% |\n",
              poses.bins.size());
  std::vector<Series> curves;
  for (const NamedDecoder& decoder : paper_decoders()) {
    Series series{decoder.name, {}, {}};
    std::printf("| %s |", decoder.name.c_str());
    for (int step = 0; step <= 10; ++step) {
      const double wrong = wrong_bins(poses, decoder, 0.05 * step, figures);
      series.x.push_back(0.05 * step);
      series.y.push_back(wrong);
      if (step % 2 == 0 && step >= 2 && step <= 8) std::printf(" %.1f%%", 100.0 * wrong);
    }
    std::printf(" |\n");
    curves.push_back(std::move(series));
  }
  return curves;
}

void figure_8(TwoStates poses, const PlaceFigures& figures, const std::filesystem::path& out) {
  LinePlot plot{.title = "Real scans, some from a wrong pose",
                .x_label = "share of such scans",
                .y_label = "wrong bins",
                .from_zero = true};
  plot.series = wrong_bins_by_share(poses, figures);
  report::save_png(plot, out / "place_figure_8.png");
  const std::size_t all = poses.bins.size();
  keep_bins_seen_as_often(poses);
  if (poses.bins.empty() || poses.bins.size() == all) return;
  std::printf("of them those that the right pose knows at least two thirds as often:\n");
  wrong_bins_by_share(poses, figures);
}

}  // namespace

void report_place(const PlaceOptions& options) {
  const memory::PolarBins bins = memory::TimescaleConfig{}.bins();
  const std::vector<PosedScan> before = posed_scans(options.before);
  std::vector<PosedScan> after = posed_scans(options.after);
  std::optional<Eigen::Vector2d> place_m = options.place_m;
  const std::vector<PosedScan> as_recorded = after;
  if (options.object) {
    if (after.empty()) throw InputError("the second occasion", "has no scan", "choose another");
    if (!place_m) place_m = after.front().map_from_laser().translation();
    RandomStream random(options.first_seed, StreamId::kTest);
    after = with_object(after, placed(*options.object, after.front()), kScannerNoise_m, random);
  }
  ChangedPlace place;
  if (place_m) {
    place = {*place_m, tell_apart(views_from(before, *place_m, options.radius_m, bins),
                                  views_from(after, *place_m, options.radius_m, bins), bins,
                                  options.min_difference_m)};
  } else {
    place = find_changed_place(before, after, options.radius_m, bins, options.min_difference_m);
  }
  const TwoStates& states = place.states;
  if (states.bins.empty()) {
    throw InputError("the place", "looks alike on both occasions, or was seen too rarely",
                     "choose another");
  }
  std::printf("node at (%.2f, %.2f): %zu and %zu views, an object of %zu angle bins\n",
              place.node_m.x(), place.node_m.y(), states.before.size(), states.after.size(),
              states.bins.size());
  std::filesystem::create_directories(options.out);
  const PlaceFigures figures{bins, 20, options.seeds, options.first_seed};
  figure_6(states, figures, options.out);
  figure_7(states, figures, options.out);
  const TwoStates poses = tell_apart(
      views_from(as_recorded, place.node_m, options.radius_m, bins),
      views_from(as_recorded, place.node_m, options.radius_m, bins, kWrong), bins, 0.3, true);
  if (!poses.bins.empty()) figure_8(poses, figures, options.out);
}

void report_decoders(const std::vector<Occasion>& logs) {
  for (const Occasion& log : logs) {
    memory::TimescaleMemory memory;
    for (const PosedScan& scan : posed_scans(log)) memory.observe(scan);
    std::printf(
        "%s\n| decoder | levels that differ | nodes | bins | by more than one | apart | less "
        "likely, mean (most) | impossible | no path |\n",
        log.log.c_str());
    const auto percent = [](std::size_t part, std::size_t whole) {
      return whole == 0 ? 0.0 : 100.0 * static_cast<double>(part) / static_cast<double>(whole);
    };
    for (const DecoderRow& row : compare_decoders(memory)) {
      std::printf(
          "| %s | %zu of %zu | %zu of %zu | %.2f%% | %.2f%% | %.2f m | %.1f (%.1f) nats | "
          "%zu | %zu |\n",
          row.name.c_str(), row.different_levels, row.levels, row.different_nodes, row.nodes,
          percent(row.different_bins, row.bins), percent(row.far_bins, row.bins), row.apart_m,
          row.log_product, row.worst_log_product, row.impossible, row.inconsistent);
    }
    std::printf("| start bins | levels | Dijkstra [ms] | exact [ms] |\n");
    for (const StartRow& row : time_by_starts(memory)) {
      std::printf("| %zu | %zu | %.3f | %.3f |\n", row.starts, row.levels, row.dijkstra_ms,
                  row.exact_ms);
    }
  }
}

}  // namespace strata::experiments
