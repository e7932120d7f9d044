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
#include "tools/report/plot_frame.hpp"

namespace strata::report {
namespace {

std::string number(double value) {
  std::ostringstream out;
  out.precision(6);
  out << (std::abs(value) < 1e-12 ? 0.0 : value);
  return out.str();
}

void draw_axes(const LinePlot& plot, const PlotFrame& frame, std::ostringstream& out) {
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

void draw_points(const Series& series, const PlotFrame& frame, std::size_t color,
                 std::ostringstream& out) {
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    if (!std::isfinite(series.x[i]) || !std::isfinite(series.y[i])) continue;
    const double y = frame.py(std::min(series.y[i], frame.y.high));
    out << "<circle class='dot s" << color << "' r='5' cx='" << number(frame.px(series.x[i]))
        << "' cy='" << number(y) << "'/>\n";
  }
}

std::string width_style(double width) {
  return width > 0.0 ? " style='stroke-width:" + number(width) + "'" : "";
}

void draw_series(const LinePlot& plot, const PlotFrame& frame, std::ostringstream& out) {
  for (std::size_t s = 0; s < plot.series.size(); ++s) {
    const Series& series = plot.series[s];
    if (plot.points) {
      draw_points(series, frame, s % kPlotColors, out);
    }
    out << "<path class='" << line_class(s) << "'" << width_style(line_width(plot, s)) << " d='";
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

void draw_legend(const LinePlot& plot, const PlotFrame& frame, std::ostringstream& out) {
  const double column = frame.width / kLegendColumns;
  double place = 0.0;
  for (const LegendEntry& entry : legend_of(plot)) {
    const double x = frame.left + column * std::fmod(place, kLegendColumns);
    const double y = kPlotTop + kLegendRow * std::floor(place / kLegendColumns);
    out << "<line class='" << entry.line_class << "'" << width_style(entry.width) << " x1='" << x
        << "' x2='" << x + 18.0 << "' y1='" << y << "' y2='" << y << "'/><text class='tick' x='"
        << x + 23.0 << "' y='" << y + 4.0 << "'>" << escape(entry.name) << "</text>\n";
    place += 1.0;
  }
}

void draw_events(const LinePlot& plot, const PlotFrame& frame, std::ostringstream& out) {
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

std::string fixed(double value, int digits) {
  std::ostringstream out;
  out.setf(std::ios::fixed);
  out.precision(digits);
  out << value;
  return out.str();
}

std::string percent(double share, int digits) { return fixed(100.0 * share, digits) + "%"; }

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
  constexpr std::array<const char*, kPlotColors> kPalette{
      "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#8a7a00", "#777777"};
  std::ostringstream out;
  out << ".plot text{font-family:'DejaVu Sans',sans-serif;fill:var(--ink,#222)}"
         ".plot .tick{font-size:11px}.plot .label{font-size:12px}"
         ".plot .title{font-size:14px;font-weight:bold}"
         ".plot .grid{stroke:var(--grid,#ddd);stroke-width:1}"
         ".plot .axes{fill:none;stroke:var(--ink,#222);stroke-width:1}"
         ".plot .event{stroke:var(--ink,#222);stroke-width:1.2}"
         ".plot .e0{stroke-dasharray:6 4}.plot .e1{stroke-dasharray:1.2 3}"
         ".plot .e2{stroke-dasharray:9 3 2 3}"
         ".plot .line{fill:none}.plot .dashed{stroke-dasharray:6 3}.plot "
         ".dot{fill:none;stroke-width:3}";
  for (std::size_t i = 0; i < kPlotColors; ++i) {
    out << ".plot .s" << i << "{stroke:" << kPalette[i] << "}";
  }
  return out.str();
}

std::string to_svg(const LinePlot& plot, bool standalone) {
  const PlotFrame frame = make_frame(plot);
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
