// SPDX-License-Identifier: Apache-2.0
/// What a timescale memory tells of change: places where two levels differ ("what changed since
/// last week"), and whether the shortest path between two points is the same on every level's map.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "memory/nodes/changed_places.hpp"
#include "memory/nodes/timescale_memory.hpp"
#include "tools/pipeline/path_planner.hpp"
#include "tools/report/drawings.hpp"

namespace strata::pipeline {

struct LevelChangesTask {
  std::string before;  ///< level; empty: the one that forgets slowest
  std::string now;     ///< level; empty: the one that forgets fastest
  std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> paths;  ///< from where to where, metres
  double robot_radius_m = 0.25;
};

/// The shortest path on one level's map.
struct LevelPath {
  std::string level;
  std::optional<Path> path;  ///< nothing: there is none
  /// Discrete Frechet distance to the path on the map of `before`, where both exist.
  std::optional<double> frechet_m;
};

struct LevelChanges {
  std::string before;
  std::string now;
  std::vector<memory::ChangedPlace> places;
  /// One a task's path, with one LevelPath a level, in the memory's order.
  std::vector<std::vector<LevelPath>> paths;
};

/// Throws ConfigError for a level that the memory does not have. O(nodes x cells in reach + cells
/// log cells a path and level).
[[nodiscard]] LevelChanges level_changes(const memory::TimescaleMemory& memory,
                                         const memory::NodeMap& map, const LevelChangesTask& task);

/// {"before", "now", "places": [{"kind", "center", "min", "max", "cells"}], "paths": [{"from",
/// "to", "levels": [{"level", "length_m", "frechet_m"}]}]}; length_m is null without a path.
[[nodiscard]] nlohmann::ordered_json to_json(const LevelChanges& changes,
                                             const LevelChangesTask& task);

/// level_NAME.png, a map a level; changes.png: the map of `before` with what appeared framed red
/// and what vanished blue; path_N.png: the map of `now` with each level's path in its own colour.
/// drawings: told of what cannot be drawn; null: that throws OutputError.
void draw_level_changes(const std::filesystem::path& folder, const memory::NodeMap& map,
                        const LevelChanges& changes, report::Drawings* drawings = nullptr);

}  // namespace strata::pipeline
