// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>

#include "memory/nodes/timescale_config.hpp"
#include "tools/laboratory/experiments/turning_robot.hpp"
#include "tools/laboratory/paper/figures.hpp"

namespace strata::paper {
namespace {

using namespace experiments;

PlaceFigures turning_figures(const Setting& setting) {
  return {memory::TimescaleConfig{}.bins(), 20, setting.seeds_or(20), setting.first_seed};
}

double real(std::size_t count) { return static_cast<double>(count); }

report::Series numbered(const std::string& name, const std::vector<double>& values) {
  report::Series series{name, {}, values};
  for (std::size_t t = 1; t <= values.size(); ++t) series.x.push_back(static_cast<double>(t));
  return series;
}

/// Ranges about the node as points; only those of the bins, where some are named.
report::Series outline(const std::string& name, const std::vector<float>& range_m,
                       const memory::PolarBins& bins, const std::vector<std::size_t>& only = {}) {
  report::Series series{name, {}, {}};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto add = [&](std::size_t bin) {
    const auto range = static_cast<double>(range_m[bin]);
    const bool is_known = std::isfinite(range) && range > 0.0;
    const double bearing = bins.center_bearing_rad(static_cast<int>(bin));
    series.x.push_back(is_known ? range * std::cos(bearing) : nan);
    series.y.push_back(is_known ? range * std::sin(bearing) : nan);
  };
  if (only.empty()) {
    for (std::size_t bin = 0; bin < range_m.size(); ++bin) add(bin);
  }
  for (const std::size_t bin : only) add(bin);
  return series;
}

Outcome adapts(const Setting& setting) {
  const PlaceFigures figures = turning_figures(setting);
  const TwoStates states = board_states(board_room(), figures.bins, setting.first_seed);
  const SwitchResult theirs = switch_states(states, decoder_named("paper"), figures);
  const SwitchResult ours = switch_states(states, decoder_named("scene"), figures);
  report::LinePlot plot{.title = "A board appears, seen by half circles",
                        .x_label = "scans since",
                        .y_label = "share of it shown (first seed)"};
  plot.series = {numbered("paper", theirs.shown), numbered("scene", ours.shown)};
  return judged(ours.never == 0 && ours.share >= 0.35 && ours.share <= 0.65 && ours.mixed < 0.5,
                "it switches too early or too late, or half-way states are shown",
                {{"bins of the board", {}, real(states.bins.size()), 0},
                 {"shown whole after [scans]", theirs.first_scan, ours.first_scan, 1},
                 {"share of new samples then", theirs.share, ours.share, 2},
                 {"mixed scans of 60", theirs.mixed, ours.mixed, 1},
                 {"seeds in which it never switches", static_cast<double>(theirs.never),
                  static_cast<double>(ours.never), 0}},
                {{"kessler-6-180", "decoded scans after the change", plot}});
}

Outcome completes(const Setting& setting) {
  const PlaceFigures figures = turning_figures(setting);
  const TurnedAway turned = turn_away(board_room(), figures.bins, setting.first_seed);
  const auto complete = [&](const char* name) {
    return static_cast<double>(complete_turned(turned, decoder_named(name), figures).complete);
  };
  const CompletionResult ours = complete_turned(turned, decoder_named("scene"), figures);
  report::LinePlot plot{.title = "The robot has turned away from half of the board",
                        .x_label = "x [m]",
                        .y_label = "y [m]"};
  plot.equal_axes = true;
  plot.points = true;
  plot.height = 520;
  plot.series = {outline("decoded", ours.decoded_m, figures.bins),
                 outline("of it, hidden", ours.decoded_m, figures.bins, turned.hidden)};
  return judged(
      ours.complete >= 0.9 * figures.seeds, "the hidden half is completed in too few seeds",
      {{"seeds", {}, static_cast<double>(figures.seeds), 0},
       {"bins of the board", {}, real(turned.states.bins.size()), 0},
       {"of them hidden", {}, real(turned.hidden.size()), 0},
       {"hidden half completed", complete("paper"), static_cast<double>(ours.complete), 0},
       {"the same by the median of each bin", {}, complete("median of each bin"), 0}},
      {{"kessler-7-180", "first seed", plot}});
}

Outcome wrong_poses(const Setting& setting) {
  const PlaceFigures figures = turning_figures(setting);
  const TwoStates states = wrong_pose_states(board_room(), figures.bins, setting.first_seed);
  const auto wrong = [&](const char* name, double share) {
    return wrong_bins(states, decoder_named(name), share, figures);
  };
  const double ours = wrong("scene", 0.3);
  return judged(ours <= 0.03, "more than 3% of the bins follow the wrong pose",
                {{"bins that differ", {}, real(states.bins.size()), 0},
                 {"wrong bins at 10% wrong scans", wrong("paper", 0.1), wrong("scene", 0.1), 3},
                 {"wrong bins at 30% wrong scans", wrong("paper", 0.3), ours, 3},
                 {"wrong bins at 70% wrong scans", wrong("paper", 0.7), wrong("scene", 0.7), 3}},
                {});
}

}  // namespace

std::vector<Figure> kessler_turning_figures() {
  const char* const material =
      "simulated scans of 180 degrees from places and headings drawn about the node, which no scan "
      "sees whole";
  return {
      {"kessler-6-180", "kessler", "A level adapts, scanner of 180 degrees",
       "it switches as a whole when most samples are new.", "as kessler-6.", material, adapts, ""},
      {"kessler-7-180", "kessler", "A half hidden by turning, scanner of 180 degrees",
       "what is hidden follows what is seen.",
       "as kessler-7; the half is hidden since the robot has turned.", material, completes, ""},
      {"kessler-8-180", "kessler", "Scans from a wrong pose, scanner of 180 degrees",
       "few of them change nothing.", "as kessler-8.", material, wrong_poses, ""}};
}

}  // namespace strata::paper
