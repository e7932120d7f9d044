// SPDX-License-Identifier: Apache-2.0
/// Exhaustive search for the pose that best registers a scan, or a whole local map, to a map: finds
/// the optimum of its window however wrong the guess is, where gradient matching would stick.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/config.hpp"
#include "core/geometry/pose2.hpp"
#include "core/grid/grid.hpp"
#include "core/registration/match_field.hpp"
#include "core/scan/endpoints.hpp"

namespace strata::registration {

struct CorrelativeConfig {
  double hit_stddev_m = 0.10;
  int depth = 6;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("hit_stddev_m", c.hit_stddev_m,
            {.doc = "how far from a surface an end point still counts",
             .unit = "m",
             .min = 0.01,
             .max = 1.0});
    v.field("depth", c.depth,
            {.doc = "levels of the branch and bound; the coarsest cell is 2^depth cells wide",
             .min = 0,
             .max = 10});
  }
};

/// Tables of exp(-D^2 / 2 sigma^2) on a map, and of its maximum over squares of 2, 4, 8, ... cells,
/// quantized to 1/255. Memory: (depth + 1) bytes a cell.
class CorrelativeTables {
 public:
  /// Over the occupied points of a field. O(points x (sigma / resolution)^2 + depth x cells).
  CorrelativeTables(const MatchField& field, const CorrelativeConfig& config);

  [[nodiscard]] double resolution_m() const { return resolution_m_; }
  [[nodiscard]] int depth() const { return static_cast<int>(levels_.size()) - 1; }
  /// Cells that hold anything but zero on the finest level.
  [[nodiscard]] const CellRect& rect() const { return rect_; }
  /// The greatest score, 0 ... 255, in the square of 2^level cells whose least corner is `cell`.
  [[nodiscard]] int at(int level, const Cell& cell) const {
    const Grid<std::uint8_t>& grid = levels_[static_cast<std::size_t>(level)];
    return grid.contains(cell) ? grid.at(cell) : 0;
  }

 private:
  double resolution_m_;
  CellRect rect_;
  std::vector<Grid<std::uint8_t>> levels_;
};

/// Half-widths of the searched box about the guess.
struct SearchWindow {
  double x_m = 1.0;
  double y_m = 1.0;
  double theta_rad = 0.3;
};

struct SearchResult {
  bool found = false;  ///< some pose of the window scores at least min_score
  Pose2 pose;
  double score = 0.0;  ///< mean over the end points, 0 ... 1
};

/// The pose of the window, on a lattice of one cell and of the turn that moves the farthest point
/// by one cell, with the greatest mean score; branch and bound [olson2009real; hess2016real], so
/// the result equals that of trying every pose. Ties: the pose nearest to the guess in steps of the
/// lattice (along a bare wall nothing else decides), then the least (turn, x, y). Poses below
/// min_score are not looked for, which is what makes it fast. O(candidates) at worst, usually a
/// small part. Thread-safe.
[[nodiscard]] SearchResult search(const Endpoints& endpoints, const CorrelativeTables& tables,
                                  const Pose2& guess, const SearchWindow& window, double min_score);

}  // namespace strata::registration
