// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "tools/laboratory/experiments/box_way.hpp"
#include "tools/laboratory/paper/patch_drawings.hpp"
#include "tools/laboratory/paper/svg_drawing.hpp"

namespace strata::paper {
namespace {

using experiments::way_through_box;
using experiments::WayThrough;

constexpr double kPixelsPerMetre = 60.0;
constexpr double kMargin = 10.0;

/// Over the seeds.
struct Ways {
  int known = 0;          ///< seeds with a way through a sub-map whose state is known
  int sure = 0;           ///< ... and with more than 0.9 for the truth when it is left
  double entering = 0.0;  ///< mean probability of the truth at the first label ...
  double leaving = 0.0;   ///< ... and at the second
  double error_m = 0.0;
};

Ways ways_of(const Setting& setting, int seeds, const std::string& model) {
  Ways ways;
  for (int i = 0; i < seeds; ++i) {
    const auto way =
        way_through_box((setting.scenarios / "corridor_box.yaml").string(), setting.seed(i), model);
    if (!way) continue;
    ++ways.known;
    ways.sure += way->probability(way->left) > 0.9 ? 1 : 0;
    ways.entering += way->probability(way->entered);
    ways.leaving += way->probability(way->left);
    ways.error_m += way->error_m();
  }
  const double known = std::max(1, ways.known);
  ways.entering /= known;
  ways.leaving /= known;
  ways.error_m /= known;
  return ways;
}

/// The part of the map about the way, with the true configuration in its place.
std::vector<Picture> draw_way(const WayThrough& way) {
  std::vector<int> configurations(way.map.submaps.size(), -1);
  configurations[way.submap] = static_cast<int>(way.true_configuration);
  const ReflectionGrid map = patch::compose(way.map, configurations, static_cast<int>(way.submap));
  const double resolution_m = map.resolution_m();
  CellRect part = way.map.submaps[way.submap].rect;
  for (const experiments::WayPoint& point : way.points) {
    const Cell cell = map.cell_at(point.truth.translation());
    part = part.united({cell, {cell.x + 1, cell.y + 1}});
  }
  part = part.inflated(static_cast<int>(std::lround(1.2 / resolution_m))).intersected(map.rect());
  const double cell = kPixelsPerMetre * resolution_m;
  const auto x = [&](double x_m) { return kMargin + cell * (x_m / resolution_m - part.min.x); };
  const auto y = [&](double y_m) { return kMargin + cell * (part.max.y - y_m / resolution_m); };
  SvgDrawing drawing(2.0 * kMargin + cell * part.width(), 2.0 * kMargin + cell * part.height());
  drawing.cells(map, part, kMargin, kMargin, cell);
  const CellRect& rect = way.map.submaps[way.submap].rect;
  drawing.frame(x(rect.min.x * resolution_m), y(rect.max.y * resolution_m), cell * rect.width(),
                cell * rect.height(), "#0072b2");
  for (std::size_t i = 1; i < way.points.size(); ++i) {
    const auto leg = [&](const Pose2& a, const Pose2& b, const char* stroke, double width) {
      drawing.line(x(a.x), y(a.y), x(b.x), y(b.y), stroke, width);
    };
    leg(way.points[i - 1].truth, way.points[i].truth, "#999999", 3.0);
    leg(way.points[i - 1].found, way.points[i].found, "#d55e00", 1.5);
  }
  for (const std::size_t i : {way.entered, way.left}) {
    const experiments::WayPoint& point = way.points[i];
    drawing.dot(x(point.found.x), y(point.found.y), 5.0, "#d55e00");
    drawing.text(x(point.found.x) - 12.0, y(point.found.y) - 12.0, 18.0,
                 report::fixed(point.time_s, 0) + " s");
  }
  return picture_of(drawing, "patch-1.14",
                    "the way as it was found (orange) and true (grey) through the sub-map (blue) "
                    "in its true configuration, first seed");
}

/// Figure 1.15 of the same way.
Picture plot_beliefs(const WayThrough& way) {
  report::LinePlot plot{.title = "What the sub-map is believed to be",
                        .x_label = "time [s]",
                        .y_label = "probability (first seed)"};
  for (std::size_t k = 0; k < way.points.front().probability.size(); ++k) {
    const bool is_true = k == way.true_configuration;
    report::Series series{"patch " + std::to_string(k) + (is_true ? " (true)" : ""), {}, {}};
    for (const experiments::WayPoint& point : way.points) {
      series.x.push_back(point.time_s);
      series.y.push_back(point.probability[k]);
    }
    plot.series.push_back(std::move(series));
  }
  plot.events = {{way.points[way.entered].time_s, "entered"},
                 {way.points[way.left].time_s, "left"}};
  return {"patch-1.14_beliefs", "over the same way", plot};
}

}  // namespace

Outcome way_with_time_labels(const Setting& setting) {
  const int seeds = setting.seeds_or(5);
  const Ways theirs = ways_of(setting, seeds, "patch_paper");
  const Ways ours = ways_of(setting, seeds, "patch");
  std::vector<Number> numbers{
      {"seeds", {}, static_cast<double>(seeds), 0},
      {"ways through a known sub-map", static_cast<double>(theirs.known),
       static_cast<double>(ours.known), 0},
      {"true configuration above 0.9 on leaving", static_cast<double>(theirs.sure),
       static_cast<double>(ours.sure), 0},
      {"its probability on entering", theirs.entering, ours.entering, 3},
      {"its probability on leaving", theirs.leaving, ours.leaving, 3},
      {"pose error between the labels [m]", theirs.error_m, ours.error_m, 3}};
  std::vector<Picture> pictures;
  const auto way = way_through_box((setting.scenarios / "corridor_box.yaml").string(),
                                   setting.first_seed, "patch");
  if (way) {
    numbers.push_back({"first label [s]", {}, way->points[way->entered].time_s, 1});
    numbers.push_back({"second label [s]", {}, way->points[way->left].time_s, 1});
    pictures = draw_way(*way);
    pictures.push_back(plot_beliefs(*way));
  }
  const bool is_sure = 10 * ours.sure >= 9 * seeds;
  return judged(is_sure && ours.error_m <= 0.25,
                is_sure ? "the way is too far from the true one"
                        : "the true configuration is not known on leaving",
                std::move(numbers), std::move(pictures));
}

}  // namespace strata::paper
