// SPDX-License-Identifier: Apache-2.0
#include "tools/report/plot_frame.hpp"

#include <algorithm>

namespace strata::report {
namespace {

constexpr double kLeft = 78.0;
constexpr double kRight = 16.0;
constexpr double kBottom = 46.0;
constexpr std::size_t kEventDashes = 3;

}  // namespace

std::vector<std::string> event_labels(const LinePlot& plot) {
  std::vector<std::string> labels;
  for (const PlotEvent& event : plot.events) {
    if (std::find(labels.begin(), labels.end(), event.label) == labels.end()) {
      labels.push_back(event.label);
    }
  }
  return labels;
}

std::string line_class(std::size_t series) {
  return "line s" + std::to_string(series % kPlotColors) + (series >= kPlotColors ? " dashed" : "");
}

double line_width(const LinePlot& plot, std::size_t series) {
  constexpr double kThinnest = 1.8;
  constexpr double kMostMore = 4.0;
  const auto steps = static_cast<double>(plot.series.size() - 1);
  const double step = std::min(1.6, kMostMore / std::max(steps, 1.0));
  return kThinnest + step * (steps - static_cast<double>(series));
}

std::string event_class(std::size_t label) {
  return "event e" + std::to_string(label % kEventDashes);
}

std::vector<LegendEntry> legend_of(const LinePlot& plot) {
  std::vector<LegendEntry> legend;
  const std::size_t named = plot.series.size() > 1 ? plot.series.size() : 0;
  for (std::size_t s = 0; s < named; ++s) {
    legend.push_back({line_class(s), line_width(plot, s), plot.series[s].name});
  }
  const std::vector<std::string> labels = event_labels(plot);
  for (std::size_t e = 0; e < labels.size(); ++e) {
    legend.push_back({event_class(e), 0.0, labels[e]});
  }
  return legend;
}

PlotFrame make_frame(const LinePlot& plot) {
  PlotFrame frame;
  frame.left = kLeft;
  for (const Series& series : plot.series) {
    for (const double x : series.x) frame.x.add(plot.log_x ? std::log10(x) : x);
    for (const double y : series.y) frame.y.add(y);
  }
  if (plot.from_zero) frame.y.add(0.0);
  frame.log_x = plot.log_x;
  if (plot.points && !plot.log_x) frame.x.add(0.0);
  frame.x.settle();
  if (plot.log_x) frame.x = {frame.x.low - 0.05, frame.x.high + 0.05};
  frame.y.settle();
  if (plot.y_max > 0.0) frame.y.high = plot.y_max;
  const auto entries = static_cast<double>(legend_of(plot).size());
  frame.top = kPlotTop + kLegendRow * std::ceil(entries / kLegendColumns);
  frame.width = plot.width - kLeft - kRight;
  frame.height = plot.height - frame.top - kBottom;
  if (plot.equal_axes) {
    // Widen the axis that has room to spare.
    const double per_pixel = std::max(frame.x.span() / frame.width, frame.y.span() / frame.height);
    const double grow_x = 0.5 * (per_pixel * frame.width - frame.x.span());
    const double grow_y = 0.5 * (per_pixel * frame.height - frame.y.span());
    frame.x = {frame.x.low - grow_x, frame.x.high + grow_x};
    frame.y = {frame.y.low - grow_y, frame.y.high + grow_y};
  }
  return frame;
}

std::vector<double> log_ticks(const PlotRange& powers) {
  std::vector<double> result;
  for (double power = std::floor(powers.low); power <= powers.high; power += 1.0) {
    for (const double digit : {1.0, 2.0, 5.0}) {
      const double tick = digit * std::pow(10.0, power);
      if (std::log10(tick) >= powers.low && std::log10(tick) <= powers.high) result.push_back(tick);
    }
  }
  return result;
}

std::vector<double> ticks(double low, double high, int count) {
  const double raw = (high - low) / count;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  double step = 10.0 * power;
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= raw) {
      step = factor * power;
      break;
    }
  }
  std::vector<double> result;
  for (double k = std::ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k += 1.0) {
    result.push_back(k * step);
  }
  return result;
}

}  // namespace strata::report
