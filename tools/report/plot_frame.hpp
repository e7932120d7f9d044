// SPDX-License-Identifier: Apache-2.0
/// Where things of a plot lie in its picture, and what its legend says.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "tools/report/plot.hpp"

namespace strata::report {

inline constexpr double kPlotTop = 34.0;
inline constexpr double kLegendRow = 18.0;
inline constexpr double kLegendColumns = 4.0;
inline constexpr std::size_t kPlotColors = 8;

struct PlotRange {
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

struct PlotFrame {
  PlotRange x;
  PlotRange y;
  double left = 0.0;
  double top = 0.0;
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

[[nodiscard]] PlotFrame make_frame(const LinePlot& plot);

/// 1, 2 and 5 of every power of ten.
[[nodiscard]] std::vector<double> log_ticks(const PlotRange& powers);

/// What events there are, in order of appearance.
[[nodiscard]] std::vector<std::string> event_labels(const LinePlot& plot);

/// Colours repeat; the second round is dashed.
[[nodiscard]] std::string line_class(std::size_t series);
[[nodiscard]] std::string event_class(std::size_t label);

/// Those drawn first are the thickest, so that of curves that lie on each other all can be seen.
[[nodiscard]] double line_width(const LinePlot& plot, std::size_t series);

struct LegendEntry {
  std::string line_class;
  double width = 0.0;  ///< 0: the class has it
  std::string name;
};

/// A line that is alone needs no name.
[[nodiscard]] std::vector<LegendEntry> legend_of(const LinePlot& plot);

}  // namespace strata::report
