// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/paper/svg_drawing.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/error.hpp"
#include "tools/report/image.hpp"
#include "tools/report/plot.hpp"

namespace strata::paper {
namespace {

std::string number(double value) { return report::fixed(value, 1); }

std::string shade(float reflection) {
  if (!is_known(reflection)) return "#b0b6be";
  const double light = 255.0 * (1.0 - static_cast<double>(std::clamp(reflection, 0.0F, 1.0F)));
  const std::string level = std::to_string(std::lround(light));
  return "rgb(" + level + "," + level + "," + level + ")";
}

}  // namespace

SvgDrawing::SvgDrawing(double width, double height) {
  out_ << "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" << number(width) << "\" height=\""
       << number(height)
       << "\" font-family=\"sans-serif\"><rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n";
}

void SvgDrawing::rect(double x, double y, double width, double height, const std::string& fill) {
  out_ << "<rect x=\"" << number(x) << "\" y=\"" << number(y) << "\" width=\"" << number(width)
       << "\" height=\"" << number(height) << "\" fill=\"" << fill << "\"/>\n";
}

void SvgDrawing::frame(double x, double y, double width, double height, const std::string& stroke) {
  out_ << "<rect x=\"" << number(x) << "\" y=\"" << number(y) << "\" width=\"" << number(width)
       << "\" height=\"" << number(height) << "\" fill=\"none\" stroke=\"" << stroke << "\"/>\n";
}

void SvgDrawing::line(double x0, double y0, double x1, double y1, const std::string& stroke,
                      double width) {
  out_ << "<line x1=\"" << number(x0) << "\" y1=\"" << number(y0) << "\" x2=\"" << number(x1)
       << "\" y2=\"" << number(y1) << "\" stroke=\"" << stroke << "\" stroke-width=\""
       << number(width) << "\"/>\n";
}

void SvgDrawing::dot(double x, double y, double radius, const std::string& fill) {
  out_ << "<circle cx=\"" << number(x) << "\" cy=\"" << number(y) << "\" r=\"" << number(radius)
       << "\" fill=\"" << fill << "\"/>\n";
}

void SvgDrawing::text(double x, double y, double size, const std::string& words) {
  out_ << "<text x=\"" << number(x) << "\" y=\"" << number(y) << "\" font-size=\"" << number(size)
       << "\" fill=\"#222\">" << report::escape(words) << "</text>\n";
}

void SvgDrawing::cells(const ReflectionGrid& map, const CellRect& part, double x, double y,
                       double cell) {
  // Neighbours in a row that are of one shade are one rectangle; crisp, so that none shines through
  // between two.
  out_ << "<g shape-rendering=\"crispEdges\">\n";
  for (int row = part.max.y - 1; row >= part.min.y; --row) {
    const double top = y + cell * (part.max.y - 1 - row);
    int begin = part.min.x;
    std::string fill = shade(map.get({begin, row}));
    for (int column = begin + 1; column <= part.max.x; ++column) {
      const std::string next = column < part.max.x ? shade(map.get({column, row})) : std::string();
      if (next == fill) continue;
      rect(x + cell * (begin - part.min.x), top, cell * (column - begin), cell, fill);
      begin = column;
      fill = next;
    }
  }
  out_ << "</g>\n";
}

std::vector<Picture> picture_of(const SvgDrawing& drawing, const std::string& name,
                                const std::string& caption) {
  try {
    return {{name, caption, report::render_svg_to_png(drawing.svg(), 1.0)}};
  } catch (const OutputError&) {
    return {};
  }
}

}  // namespace strata::paper
