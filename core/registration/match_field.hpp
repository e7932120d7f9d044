// SPDX-License-Identifier: Apache-2.0
/// The map as scan matching sees it: pieces of surface, and for every cell the nearest of them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/base/config.hpp"
#include "core/grid/grid.hpp"
#include "core/grid/reflection_grid.hpp"
#include "core/scan/endpoints.hpp"

namespace strata::registration {

/// One occupied cell: where the beams hit it and which way its surface runs. A look-up touches one
/// line of the cache.
struct alignas(64) SurfacePoint {
  double x_m = 0.0;
  double y_m = 0.0;
  double normal_x = 1.0;  ///< unit normal of the surface, either sign
  double normal_y = 0.0;
  /// Share in (0, 1] with which distance along the surface counts: small on a wall, 1 at a lone
  /// point or a corner, where the normal says nothing.
  double tangential = 1.0;
  /// Distance along the surface that costs nothing: the surface goes on that far, though no beam
  /// hit it in between.
  double slack_m = 0.0;
  bool occupied = true;  ///< false: once occupied, since seen free; beams there match nothing

  /// For saved states.
  template <class Self, class Archive>
  static void state(Self& self, Archive& archive) {
    for (auto* value :
         {&self.x_m, &self.y_m, &self.normal_x, &self.normal_y, &self.tangential, &self.slack_m}) {
      archive(*value);
    }
    archive(self.occupied);
  }
};

/// How far `along_m` lies beyond the slack on either side; 0 within.
[[nodiscard]] inline double beyond(double along_m, double slack_m) {
  return along_m - std::clamp(along_m, -slack_m, slack_m);
}

struct MatchFieldConfig {
  double radius_m = 0.6;
  double occupied_reflection = kSurfaceReflection;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("radius_m", c.radius_m,
            {.doc = "beams farther than this from any surface match nothing",
             .unit = "m",
             .min = 0.05,
             .max = 5.0});
    v.field("occupied_reflection", c.occupied_reflection,
            {.doc = "cells with at least this reflection probability are surface",
             .unit = "1",
             .min = 0.01,
             .max = 1.0});
  }
};

/// The distance D of docs/theory/slam.md, "Registration", to the line through the nearest occupied
/// cell's hits, not to the cell's centre: a wall anywhere inside its cells is then matched exactly,
/// and sliding along it costs nothing up to the next hit or the wall's end. Points may be added and
/// moved; the nearest point is kept per cell (by its centre), so a query is one look-up.
class MatchField {
 public:
  explicit MatchField(double resolution_m = 0.05, const MatchFieldConfig& config = {});
  /// Every cell of `map` with at least config.occupied_reflection becomes a point at its centre;
  /// normals from the 5 x 5 neighbourhood. O(cells + occupied x (radius / resolution)^2).
  explicit MatchField(const ReflectionGrid& map, const MatchFieldConfig& config = {});

  [[nodiscard]] double resolution_m() const { return nearest_.resolution_m(); }
  [[nodiscard]] const MatchFieldConfig& config() const { return config_; }
  [[nodiscard]] const std::vector<SurfacePoint>& points() const { return points_; }
  /// Index into points() by cell, -1: none within the radius.
  [[nodiscard]] const Grid<std::int32_t>& nearest_points() const { return nearest_; }

  /// Makes room for points up to these corners at once, where many are to come: growing point by
  /// point copies the field again and again. O(area).
  void reserve(const Eigen::Vector2d& min_m, const Eigen::Vector2d& max_m);
  /// Gives back what only `add` needs: the points are all there.
  void forget_distances() {
    squared_m2_ = Grid<float>(resolution_m(), CellRect{}, squared_m2_.fill());
  }
  /// Adds a point and takes over the cells that are nearest to it; returns its index.
  std::size_t add(const SurfacePoint& point);
  /// Changes a point in place; which cells are nearest to it stays as it was when it was added, so
  /// it should move by less than a cell.
  void set(std::size_t index, const SurfacePoint& point) { points_[index] = point; }

  /// The point is no longer occupied.
  void hide(std::size_t index) { points_[index].occupied = false; }

  /// The surface nearest to the centre of the cell at (x, y); null when none lies within the
  /// radius, or it is no longer occupied. O(1).
  [[nodiscard]] const SurfacePoint* nearest(double x_m, double y_m) const {
    const Cell cell{cell_coordinate(x_m, resolution_m()), cell_coordinate(y_m, resolution_m())};
    if (!nearest_.contains(cell)) return nullptr;
    const std::int32_t index = nearest_.at(cell);
    if (index < 0) return nullptr;
    const SurfacePoint& point = points_[static_cast<std::size_t>(index)];
    return point.occupied ? &point : nullptr;
  }

  /// For saved states; the config is the constructor's.
  template <class Self, class Archive>
  static void state(Self& self, Archive& archive) {
    archive(self.points_);
    archive(self.nearest_);
    archive(self.squared_m2_);
    if constexpr (!std::is_const_v<Self>) {
      if (!self.is_sound()) archive.fail("has a damaged field");
    }
  }

 private:
  /// Whether every cell names a point that is there, or none.
  [[nodiscard]] bool is_sound() const;
  [[nodiscard]] int reach_cells() const;
  void hold(const CellRect& rect);
  MatchFieldConfig config_;
  std::vector<SurfacePoint> points_;
  Grid<std::int32_t> nearest_;  // index into points_, -1: none
  Grid<float> squared_m2_;      // squared distance from the cell's centre to that point
};

/// Scatter of directions: sum of w n n^T over unit normals n, of which the cell's surface direction
/// follows. Isotropic evidence (no direction known) adds w/2 to xx and yy.
struct NormalScatter {
  float xx = 0.0F;
  float xy = 0.0F;
  float yy = 0.0F;
};

/// What its neighbours in the sweep say about one hit.
struct SweepSurface {
  /// Trace 1; empty for a hit by itself whose neighbours passed too far from it to say more.
  NormalScatter normal;
  /// How far along the surface the nearest known thing lies, on the side where that is farther:
  /// the next hit on it, or its end. Infinite where the surface goes out of sight (no return,
  /// something in front, the edge of the sweep).
  float slack_m = std::numeric_limits<float>::infinity();
};

/// Sets normal and tangential share of `point` from the scatter: the principal axis, and the ratio
/// of the eigenvalues. An empty scatter gives tangential 1.
void set_surface_direction(SurfacePoint& point, const NormalScatter& scatter);

/// The normal of the line that points lie on, blended with isotropy by how round they lie: trace 1.
/// Empty for fewer than three.
[[nodiscard]] NormalScatter normal_of(std::span<const Eigen::Vector2d> points_m);

/// The surface at each point from its neighbours in the sweep: up to three on each side and not
/// farther than a few beams' spacing, or, at grazing angles, the next ones on one line. The
/// neighbours in a scan say more than those in the map, whose cells lie too far apart where the
/// beams do. endpoints: in the order of the beams. O(points).
void surfaces_in_sweep(const Endpoints& endpoints, double beam_spacing_rad,
                       std::vector<SweepSurface>& out);

}  // namespace strata::registration
