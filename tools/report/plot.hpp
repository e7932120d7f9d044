// SPDX-License-Identifier: Apache-2.0
/// Line plots as SVG that follows the page's light or dark theme, and as data.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace strata::report {

/// One line. NaN breaks it. Equal lengths of x and y.
struct Series {
  std::string name;
  std::vector<double> x;
  std::vector<double> y;
};

/// A moment to mark, such as "door 2 opens". Those with the same label are drawn alike, and the
/// legend says once what they are: a busy day has dozens.
struct PlotEvent {
  double x = 0.0;
  std::string label;
};

struct LinePlot {
  std::string title;
  std::string x_label;  ///< with unit
  std::string y_label;
  std::vector<Series> series = {};
  std::vector<PlotEvent> events = {};
  bool equal_axes = false;  ///< one metre is as long in x as in y
  bool from_zero = false;   ///< the y axis begins at 0
  double y_max = 0.0;       ///< > 0: the y axis ends here
  bool points = false;      ///< dots, joined by lines
  bool log_x = false;       ///< the x axis counts in powers of ten; x must be positive
  int width = 760;
  int height = 340;
};

/// A self-contained <svg> element with title, axes, grid, legend. Colours are CSS classes s0..s7
/// that the document styles; `standalone` adds light styles inside, for files and PNG.
[[nodiscard]] std::string to_svg(const LinePlot& plot, bool standalone);

/// Writes it as a picture, in light colours. Throws OutputError.
void save_png(const LinePlot& plot, const std::filesystem::path& file);

/// "series,x,y" rows with a header line, 9 significant digits.
[[nodiscard]] std::string to_csv(const LinePlot& plot);

/// Round numbers that cover [low, high] in about `count` steps.
[[nodiscard]] std::vector<double> ticks(double low, double high, int count);

/// Text safe inside XML and HTML.
[[nodiscard]] std::string escape(const std::string& text);

/// A number with so many digits after the point.
[[nodiscard]] std::string fixed(double value, int digits);
/// "12.5%" of a share from 0 to 1, with so many digits behind the point.
[[nodiscard]] std::string percent(double share, int digits);

/// The rules for .plot classes, shared by standalone SVG and the page.
[[nodiscard]] std::string plot_style();

}  // namespace strata::report
