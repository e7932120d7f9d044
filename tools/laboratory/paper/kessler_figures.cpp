// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "core/base/error.hpp"
#include "memory/nodes/timescale_memory.hpp"
#include "tools/laboratory/experiments/decoder_table.hpp"
#include "tools/laboratory/experiments/place_figures.hpp"
#include "tools/laboratory/experiments/put_object.hpp"
#include "tools/laboratory/paper/figures.hpp"

namespace strata::paper {
namespace {

using namespace experiments;

constexpr double kScannerNoise_m = 0.01;
constexpr double kRadius_m = 0.5;

Occasion intel(const Setting& setting, double from_s, double to_s) {
  return {data_file(setting, "intel/intel.clf.gz"), data_file(setting, "intel/intel.ref.txt"),
          from_s, to_s};
}

PlaceFigures switching_figures(const Setting& setting) {
  return {memory::TimescaleConfig{}.bins(), 20, setting.seeds_or(20), setting.first_seed};
}

/// A robot that stands; in the second half a board stands before it, or it is taken to stand
/// elsewhere.
TwoStates states_of(const Setting& setting, bool is_pose) {
  const memory::PolarBins bins = memory::TimescaleConfig{}.bins();
  const auto before = posed_scans(intel(setting, 0.0, 14.0));
  const auto after = posed_scans(intel(setting, 14.0, 28.0));
  if (after.empty()) throw InputError("the log", "has no scan there", "use the log of the README");
  const Eigen::Vector2d place_m = after.front().map_from_laser().translation();
  if (is_pose) {
    return tell_apart(views_from(after, place_m, kRadius_m, bins),
                      views_from(after, place_m, kRadius_m, bins, Pose2{-0.3, 0.2, 0.1}), bins, 0.3,
                      true);
  }
  RandomStream random(setting.first_seed, StreamId::kTest);
  const auto changed =
      with_object(after, placed({1.0, 0.7}, after.front()), kScannerNoise_m, random);
  return tell_apart(views_from(before, place_m, kRadius_m, bins),
                    views_from(changed, place_m, kRadius_m, bins), bins, 0.3);
}

Outcome figure_6(const Setting& setting) {
  const TwoStates states = states_of(setting, false);
  const SwitchResult theirs =
      switch_states(states, decoder_named("paper"), switching_figures(setting));
  const SwitchResult ours =
      switch_states(states, decoder_named("scene"), switching_figures(setting));
  report::LinePlot plot{.title = "A board appears",
                        .x_label = "scans since",
                        .y_label = "share of it shown (first seed)"};
  for (const auto* result : {&theirs, &ours}) {
    report::Series series{result == &theirs ? "paper" : "scene", {}, result->shown};
    for (std::size_t t = 1; t <= result->shown.size(); ++t)
      series.x.push_back(static_cast<double>(t));
    plot.series.push_back(std::move(series));
  }
  return judged(ours.never == 0 && ours.share >= 0.35 && ours.share <= 0.65 && ours.mixed < 0.5,
                "it switches too early or too late, or half-way states are shown",
                {{"shown whole after [scans]", theirs.first_scan, ours.first_scan, 1},
                 {"share of new samples then", theirs.share, ours.share, 2},
                 {"mixed scans of 60", theirs.mixed, ours.mixed, 1},
                 {"seeds in which it never switches", static_cast<double>(theirs.never),
                  static_cast<double>(ours.never), 0}},
                {{"kessler-6", "decoded scans after the change", plot}});
}

Outcome figure_7(const Setting& setting) {
  const TwoStates states = states_of(setting, false);
  const PlaceFigures figures = switching_figures(setting);
  const auto complete = [&](const char* name) {
    return static_cast<double>(complete_half(states, decoder_named(name), figures).complete);
  };
  const double ours = complete("scene");
  return judged(ours >= 0.9 * figures.seeds, "the hidden half is completed in too few seeds",
                {{"seeds", {}, static_cast<double>(figures.seeds), 0},
                 {"hidden half completed", complete("paper"), ours, 0},
                 {"the same by the median of each bin", {}, complete("median of each bin"), 0}},
                {});
}

Outcome figure_8(const Setting& setting) {
  const TwoStates states = states_of(setting, true);
  const auto wrong = [&](const char* name, double share) {
    return wrong_bins(states, decoder_named(name), share, switching_figures(setting));
  };
  const double ours = wrong("scene", 0.3);
  return judged(ours <= 0.03, "more than 3% of the bins follow the wrong pose",
                {{"wrong bins at 10% wrong scans", wrong("paper", 0.1), wrong("scene", 0.1), 3},
                 {"wrong bins at 30% wrong scans", wrong("paper", 0.3), ours, 3},
                 {"wrong bins at 70% wrong scans", wrong("paper", 0.7), wrong("scene", 0.7), 3}},
                {});
}

Outcome table_1(const Setting& setting) {
  memory::TimescaleMemory memory;
  for (const PosedScan& scan : posed_scans(intel(setting, 0.0, 300.0))) memory.observe(scan);
  std::vector<Number> numbers;
  double n = 0.0, sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0, syy = 0.0, worst_ms = 0.0;
  for (const StartRow& row : time_by_starts(memory)) {
    if (row.levels == 0 || row.starts == 0) continue;
    const double x = static_cast<double>(row.starts);
    const double y = row.dijkstra_ms;
    n += 1.0, sx += x, sy += y, sxx += x * x, sxy += x * y, syy += y * y;
    worst_ms = std::max(worst_ms, y / x);
    numbers.push_back(
        {"CPU time, start bins " + std::to_string(row.starts) + " [ms]", y, row.exact_ms, 3});
  }
  const double top = n * sxy - sx * sy;
  const double r2 = top * top / ((n * sxx - sx * sx) * (n * syy - sy * sy));
  numbers.push_back({"R² of a line through the times", r2, {}, 3});
  numbers.push_back({"CPU time for each start, most [ms]", worst_ms, {}, 3});
  return judged(r2 > 0.95 && top > 0.0 && worst_ms < 10.0 && n >= 3.0,
                n < 3.0 ? "levels have fewer than three numbers of start bins"
                : r2 <= 0.95 || top <= 0.0
                    ? "the times do not lie on a rising line: other things than the start bins "
                      "decide how long a search takes"
                    : "a start takes too long",
                numbers, {});
}

}  // namespace

std::vector<Figure> kessler_figures() {
  const char* const board =
      "real scans of a standing robot (Intel 0 to 28 s), a board put into them";
  return {
      {"kessler-6", "kessler", "A level adapts to a new state",
       "it switches as a whole when most samples are new.",
       "it switches in every seed at a share of 0.35 to 0.65, with less than half a mixed scan.",
       board, figure_6, ""},
      {"kessler-7", "kessler", "A hidden half is completed", "what is hidden follows what is seen.",
       "in at least 90% of the seeds.", board, figure_7, ""},
      {"kessler-8", "kessler", "Scans from a wrong pose", "few of them change nothing.",
       "at 30% wrong scans at most 3% of the bins are wrong.",
       "real scans of a standing robot (Intel 14 to 28 s)", figure_8, ""},
      {"kessler-table-1", "kessler", "Time by start bins", "nearly linear, 24 ms each.",
       "in the paper's form R² > 0.95 of a rising line, and less than 10 ms for each start.",
       "levels learned from Intel's first 300 s", table_1, ""}};
}

}  // namespace strata::paper
