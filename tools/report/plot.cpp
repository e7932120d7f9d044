// SPDX-License-Identifier: Apache-2.0
#include "tools/report/plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <sstream>
#include <utility>

#include "tools/report/image.hpp"

namespace strata::report {
namespace {

constexpr double kLeft = 78.0;
constexpr double kRight = 16.0;
constexpr double kTop = 34.0;
constexpr double kBottom = 46.0;
constexpr double kLegendRow = 18.0;
constexpr double kLegendColumns = 4.0;
constexpr std::size_t kColors = 8;
constexpr std::size_t kEventDashes = 3;

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void add(double value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  void settle() {
    if (!(low <= high)) *this = {0.0, 1.0};
    if (high - low < 1e-12) {
      low -= 0.5;
      high += 0.5;
    }
  }
  [[nodiscard]] double span() const { return high - low; }
};

struct Frame {
  Range x;
  Range y;
  double left = kLeft;
  double top = kTop;
  double width = 0.0;
  double height = 0.0;
  bool log_x = false;  ///< x holds powers of ten
  [[nodiscard]] double px(double value) const {
    return left + ((log_x ? std::log10(value) : value) - x.low) / x.span() * width;
  }
  [[nodiscard]] double py(double value) const {
    return top + height - (value - y.low) / y.span() * height;
  }
};

std::string number(double value) {
  std::ostringstream out;
  out.precision(6);
  out << (std::abs(value) < 1e-12 ? 0.0 : value);
  return out.str();
}

/// What events there are, in order of appearance.
std::vector<std::string> event_labels(const LinePlot& plot) {
  std::vector<std::string> labels;
  for (const PlotEvent& event : plot.events) {
    if (std::find(labels.begin(), labels.end(), event.label) == labels.end()) {
      labels.push_back(event.label);
    }
  }
  return labels;
}

/// Colours repeat; the second round is dashed.
std::string line_class(std::size_t series) {
  return "line s" + std::to_string(series % kColors) + (series >= kColors ? " dashed" : "");
}

std::string event_class(std::size_t label) {
  return "event e" + std::to_string(label % kEventDashes);
}

struct LegendEntry {
  std::string line_class;
  std::string name;
};

/// A line that is alone needs no name.
std::vector<LegendEntry> legend_of(const LinePlot& plot) {
  std::vector<LegendEntry> legend;
  const std::size_t named = plot.series.size() > 1 ? plot.series.size() : 0;
  for (std::size_t s = 0; s < named; ++s) {
    legend.push_back({line_class(s), plot.series[s].name});
  }
  const std::vector<std::string> labels = event_labels(plot);
  for (std::size_t e = 0; e < labels.size(); ++e) {
    legend.push_back({event_class(e), labels[e]});
  }
  return legend;
}

Frame make_frame(const LinePlot& plot) {
  Frame frame;
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
  frame.top = kTop + kLegendRow * std::ceil(entries / kLegendColumns);
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

/// 1, 2 and 5 of every power of ten.
std::vector<double> log_ticks(const Range& powers) {
  std::vector<double> result;
  for (double power = std::floor(powers.low); power <= powers.high; power += 1.0) {
    for (const double digit : {1.0, 2.0, 5.0}) {
      const double tick = digit * std::pow(10.0, power);
      if (std::log10(tick) >= powers.low && std::log10(tick) <= powers.high) result.push_back(tick);
    }
  }
  return result;
}

void draw_axes(const LinePlot& plot, const Frame& frame, std::ostringstream& out) {
  const double right = frame.left + frame.width;
  const double bottom = frame.top + frame.height;
  for (const double tick : plot.log_x ? log_ticks(frame.x) : ticks(frame.x.low, frame.x.high, 8)) {
    const std::string x = number(frame.px(tick));
    out << "<line class='grid' x1='" << x << "' x2='" << x << "' y1='" << frame.top << "' y2='"
        << bottom << "'/><text class='tick' text-anchor='middle' x='" << x << "' y='"
        << bottom + 16.0 << "'>" << number(tick) << "</text>\n";
  }
  for (const double tick : ticks(frame.y.low, frame.y.high, 5)) {
    const std::string y = number(frame.py(tick));
    out << "<line class='grid' y1='" << y << "' y2='" << y << "' x1='" << frame.left << "' x2='"
        << right << "'/><text class='tick' text-anchor='end' x='" << frame.left - 6.0 << "' y='"
        << number(frame.py(tick) + 4.0) << "'>" << number(tick) << "</text>\n";
  }
  out << "<rect class='axes' x='" << frame.left << "' y='" << frame.top << "' width='"
      << frame.width << "' height='" << frame.height << "'/>\n";
  out << "<text class='label' text-anchor='middle' x='" << frame.left + 0.5 * frame.width << "' y='"
      << plot.height - 8 << "'>" << escape(plot.x_label) << "</text>\n";
  const double middle = frame.top + 0.5 * frame.height;
  out << "<text class='label' text-anchor='middle' transform='translate(14 " << middle
      << ") rotate(-90)'>" << escape(plot.y_label) << "</text>\n";
}

void draw_points(const Series& series, const Frame& frame, std::size_t color,
                 std::ostringstream& out) {
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    if (!std::isfinite(series.x[i]) || !std::isfinite(series.y[i])) continue;
    const double y = frame.py(std::min(series.y[i], frame.y.high));
    out << "<circle class='dot s" << color << "' r='5' cx='" << number(frame.px(series.x[i]))
        << "' cy='" << number(y) << "'/>\n";
  }
}

void draw_series(const LinePlot& plot, const Frame& frame, std::ostringstream& out) {
  for (std::size_t s = 0; s < plot.series.size(); ++s) {
    const Series& series = plot.series[s];
    if (plot.points) {
      draw_points(series, frame, s % kColors, out);
    }
    out << "<path class='" << line_class(s) << "' d='";
    bool pen_down = false;
    for (std::size_t i = 0; i < series.x.size(); ++i) {
      if (!std::isfinite(series.x[i]) || !std::isfinite(series.y[i])) {
        pen_down = false;
        continue;
      }
      const double y = std::min(series.y[i], frame.y.high);
      out << (pen_down ? 'L' : 'M') << number(frame.px(series.x[i])) << ' ' << number(frame.py(y));
      pen_down = true;
    }
    out << "'/>\n";
  }
}

void draw_legend(const LinePlot& plot, const Frame& frame, std::ostringstream& out) {
  const double column = frame.width / kLegendColumns;
  double place = 0.0;
  for (const LegendEntry& entry : legend_of(plot)) {
    const double x = frame.left + column * std::fmod(place, kLegendColumns);
    const double y = kTop + kLegendRow * std::floor(place / kLegendColumns);
    out << "<line class='" << entry.line_class << "' x1='" << x << "' x2='" << x + 18.0 << "' y1='"
        << y << "' y2='" << y << "'/><text class='tick' x='" << x + 23.0 << "' y='" << y + 4.0
        << "'>" << escape(entry.name) << "</text>\n";
    place += 1.0;
  }
}

void draw_events(const LinePlot& plot, const Frame& frame, std::ostringstream& out) {
  const std::vector<std::string> labels = event_labels(plot);
  for (const PlotEvent& event : plot.events) {
    if (event.x < frame.x.low || event.x > frame.x.high) continue;
    const auto label = std::find(labels.begin(), labels.end(), event.label) - labels.begin();
    const double x = frame.px(event.x);
    out << "<line class='" << event_class(static_cast<std::size_t>(label)) << "' x1='" << x
        << "' x2='" << x << "' y1='" << frame.top << "' y2='" << frame.top + frame.height
        << "'><title>" << escape(event.label) << "</title></line>\n";
  }
}

}  // namespace

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

std::string fixed(double value, int digits) {
  std::ostringstream out;
  out.setf(std::ios::fixed);
  out.precision(digits);
  out << value;
  return out.str();
}

std::string escape(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      case '\'':
        result += "&#39;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

std::string plot_style() {
  // Okabe and Ito's palette, which colour-blind readers can tell apart.
  constexpr std::array<const char*, kColors> kPalette{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                      "#e69f00", "#56b4e9", "#8a7a00", "#777777"};
  std::ostringstream out;
  out << ".plot text{font-family:'DejaVu Sans',sans-serif;fill:var(--ink,#222)}"
         ".plot .tick{font-size:11px}.plot .label{font-size:12px}"
         ".plot .title{font-size:14px;font-weight:bold}"
         ".plot .grid{stroke:var(--grid,#ddd);stroke-width:1}"
         ".plot .axes{fill:none;stroke:var(--ink,#222);stroke-width:1}"
         ".plot .event{stroke:var(--ink,#222);stroke-width:1.2}"
         ".plot .e0{stroke-dasharray:6 4}.plot .e1{stroke-dasharray:1.2 3}"
         ".plot .e2{stroke-dasharray:9 3 2 3}"
         ".plot .line{fill:none;stroke-width:1.8}.plot .dashed{stroke-dasharray:6 3}.plot "
         ".dot{fill:none;stroke-width:3}";
  for (std::size_t i = 0; i < kColors; ++i) {
    out << ".plot .s" << i << "{stroke:" << kPalette[i] << "}";
  }
  return out.str();
}

std::string to_svg(const LinePlot& plot, bool standalone) {
  const Frame frame = make_frame(plot);
  std::ostringstream out;
  out.precision(6);
  out << "<svg xmlns='http://www.w3.org/2000/svg' class='plot' role='img' aria-label='"
      << escape(plot.title) << "' viewBox='0 0 " << plot.width << ' ' << plot.height << "' width='"
      << plot.width << "' height='" << plot.height << "'>\n";
  if (standalone) {
    // The stand-alone renderer knows no custom properties: put the light colours in their place.
    std::string style = plot_style();
    for (const auto& [name, value] :
         {std::pair<std::string, std::string>{"var(--ink,#222)", "#222"},
          {"var(--grid,#ddd)", "#ddd"}}) {
      for (std::size_t at = style.find(name); at != std::string::npos; at = style.find(name)) {
        style.replace(at, name.size(), value);
      }
    }
    out << "<style>" << style << "</style>\n";
  }
  out << "<text class='title' x='" << frame.left << "' y='18'>" << escape(plot.title)
      << "</text>\n";
  draw_axes(plot, frame, out);
  draw_events(plot, frame, out);
  draw_series(plot, frame, out);
  draw_legend(plot, frame, out);
  out << "</svg>\n";
  return out.str();
}

void save_png(const LinePlot& plot, const std::filesystem::path& file) {
  constexpr double kPixels = 1.5;
  write_file(file, render_svg_to_png(to_svg(plot, true), kPixels));
}

std::string to_csv(const LinePlot& plot) {
  std::ostringstream out;
  out.precision(9);
  out << "series,x,y\n";
  for (const Series& series : plot.series) {
    for (std::size_t i = 0; i < series.x.size(); ++i) {
      out << series.name << ',' << series.x[i] << ',' << series.y[i] << '\n';
    }
  }
  return out.str();
}

}  // namespace strata::report
