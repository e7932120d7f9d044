// SPDX-License-Identifier: Apache-2.0
// What patch maps and the timescale memory know, in the report of a comparison.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "tools/pipeline/comparison_figures.hpp"
#include "tools/report/map_picture.hpp"

namespace strata::pipeline {
namespace {

using report::HtmlReport;
using report::LinePlot;
using report::Series;

constexpr int kMapPixels = 900;

struct TracedModel {
  std::string model;
  const StateTrace* trace = nullptr;
};

/// The trace with the largest swing of its first configuration says most.
TracedModel most_telling(const Comparison& comparison) {
  TracedModel best;
  double best_swing = 0.0;
  for (const ModelResult& model : comparison.models) {
    for (const StateTrace& trace : model.states) {
      if (trace.probability.size() < 2) continue;
      const auto [low, high] =
          std::minmax_element(trace.probability[0].begin(), trace.probability[0].end());
      if (*high - *low <= best_swing && best.trace != nullptr) continue;
      best_swing = *high - *low;
      best = {model.model, &trace};
    }
  }
  return best;
}

/// Bearings at which the first level, what is here lately, and the last expect different things.
std::size_t differing_beams(const memory::NodeMap& nodes, int node) {
  constexpr float kDiffers_m = 0.3F;
  const Scan now = nodes.expected_scan(0, node);
  const Scan usually = nodes.expected_scan(static_cast<int>(nodes.level_names().size()) - 1, node);
  std::size_t count = 0;
  for (std::size_t beam = 0; beam < now.size(); ++beam) {
    // Infinite against infinite is no number, and not counted.
    if (std::abs(now.ranges_m[beam] - usually.ranges_m[beam]) > kDiffers_m) ++count;
  }
  return count;
}

/// The node that shows best what levels are for; of equals the one with the most observations.
int most_telling_node(const memory::NodeMap& nodes) {
  std::pair<std::size_t, std::uint64_t> best;
  int telling = 0;
  for (std::size_t n = 0; n < nodes.nodes().size(); ++n) {
    const std::pair<std::size_t, std::uint64_t> own(differing_beams(nodes, static_cast<int>(n)),
                                                    nodes.nodes()[n].observations);
    if (own <= best) continue;
    best = own;
    telling = static_cast<int>(n);
  }
  return telling;
}

}  // namespace

void add_states(const Comparison& comparison, HtmlReport& page) {
  const auto [model, trace] = most_telling(comparison);
  if (trace == nullptr) return;
  LinePlot plot{.title = "Posterior over the configurations of sub-map " +
                         std::to_string(trace->submap) + " (" + model + ")",
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

void add_timescale(const LearnResult& learned, const maps::Maps& maps, HtmlReport& page) {
  if (!learned.timescale || learned.timescale->nodes().empty()) return;
  const auto nodes = learned.timescale->decode(maps.decoding);
  page.heading("Timescale memory: what is here lately, and usually");
  const int node = most_telling_node(*nodes);
  const Eigen::Vector2d& center_m = nodes->nodes()[static_cast<std::size_t>(node)].position_m;
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
      series.x.push_back(known ? center_m.x() + range_m * std::cos(bearing) : kBreak);
      series.y.push_back(known ? center_m.y() + range_m * std::sin(bearing) : kBreak);
    }
    plot.series.push_back(std::move(series));
  }
  page.plot("node_levels", plot,
            "What each level expects around the node where they differ most; gaps: nothing within "
            "reach, or never seen.");
  for (std::size_t level = 0; level < nodes->level_names().size(); ++level) {
    const std::string& name = nodes->level_names()[level];
    const ReflectionGrid map = nodes->level_map(static_cast<int>(level));
    page.picture("level_" + name, report::draw_map(map, report::known_rect(map), kMapPixels).image,
                 "The map that the level " + name + " expects", "Level " + name + ".");
  }
}

}  // namespace strata::pipeline
