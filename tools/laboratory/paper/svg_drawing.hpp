// SPDX-License-Identifier: Apache-2.0
/// Pictures of figures that need words beside what is drawn: SVG, y downwards.
#pragma once

#include <sstream>
#include <string>
#include <vector>

#include "core/grid/reflection_grid.hpp"
#include "tools/laboratory/paper/figure.hpp"

namespace strata::paper {

class SvgDrawing {
 public:
  SvgDrawing(double width, double height);

  void rect(double x, double y, double width, double height, const std::string& fill);
  void frame(double x, double y, double width, double height, const std::string& stroke);
  void line(double x0, double y0, double x1, double y1, const std::string& stroke, double width);
  void dot(double x, double y, double radius, const std::string& fill);
  void text(double x, double y, double size, const std::string& words);
  /// A part of a map, north up, its upper left corner at (x, y): white free, black occupied, grey
  /// unknown.
  void cells(const ReflectionGrid& map, const CellRect& part, double x, double y, double cell);
  /// The whole document.
  [[nodiscard]] std::string svg() const { return out_.str() + "</svg>\n"; }

 private:
  std::ostringstream out_;
};

/// Its PNG; nothing where it cannot be drawn, which costs no figure its numbers.
[[nodiscard]] std::vector<Picture> picture_of(const SvgDrawing& drawing, const std::string& name,
                                              const std::string& caption);

}  // namespace strata::paper
