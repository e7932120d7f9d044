// SPDX-License-Identifier: Apache-2.0
/// What is another way in one map than in another of the same frame (docs/site.md, "Differences").
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "core/grid/cell_outline.hpp"
#include "core/grid/counting_map.hpp"
#include "core/grid/reflection_grid.hpp"
#include "core/patch/patch_map.hpp"
#include "tools/report/image.hpp"

namespace strata::site {

/// What a difference is told from: of a MAPS folder, or made in a test.
struct DiffSide {
  ReflectionGrid map;       ///< the filtered map
  Grid<CellCounts> counts;  ///< how often each cell was looked at; may be empty
  std::vector<patch::Submap> submaps;
};
/// Throws InputError.
[[nodiscard]] DiffSide read_diff_side(const std::filesystem::path& maps);

struct DiffConfig {
  double tolerance_m = 0.1;      ///< walls that lie so near each other are the same
  double min_area_m2 = 0.02;     ///< smaller differences are noise of single beams
  double min_explored_m2 = 1.0;  ///< of areas that only one map knows
  double max_move_m = 3.0;       ///< things that are alike and nearer than that have moved
};

enum class ChangeKind {
  kCame,       ///< free before, occupied after
  kWent,       ///< occupied before, free after
  kMoved,      ///< one of each, alike and near: where it is after
  kExplored,   ///< unknown before
  kForgotten,  ///< unknown after
  kPlaceCame,  ///< a changeable area (sub-map) that was none before
  kPlaceWent,  ///< ... that is none after
};
[[nodiscard]] const char* name_of(ChangeKind kind);

struct MapChange {
  ChangeKind kind = ChangeKind::kCame;
  std::vector<CellPolygon> shape;
  double area_m2 = 0.0;
  /// Mean over the cells of the probability that each is in the one state before and in the other
  /// after, by how often beams went through and ended there; 1 for what is known or not.
  double confidence = 1.0;
  Eigen::Vector2d center_m = Eigen::Vector2d::Zero();
  std::optional<Eigen::Vector2d> from_m;  ///< its centre before it moved
};

struct MapDiff {
  double resolution_m = 0.05;
  std::vector<MapChange> changes;  ///< kinds in their order, within one the largest first
};

/// Requires one frame and one lattice; throws InputError where cells differ in size. O(cells).
[[nodiscard]] MapDiff map_diff(const DiffSide& before, const DiffSide& after,
                               const DiffConfig& config = {});

/// A FeatureCollection of MultiPolygons in metres of `frame`; each feature has kind, area_m2,
/// confidence, center and, when it moved, from.
[[nodiscard]] nlohmann::json to_geojson(const MapDiff& diff, const std::string& frame);

/// The later map, and on it what came (red), went (blue), moved (orange, with a line from where it
/// was), was explored (green), was forgotten (grey), and changeable areas (purple).
[[nodiscard]] report::Image draw(const MapDiff& diff, const DiffSide& before,
                                 const DiffSide& after);

}  // namespace strata::site
