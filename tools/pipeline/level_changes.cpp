// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/level_changes.hpp"

#include <algorithm>
#include <array>

#include "components/maps/changes_json.hpp"
#include "tools/report/map_picture.hpp"

namespace strata::pipeline {
namespace {

using memory::NodeMap;
using Json = nlohmann::ordered_json;

constexpr double kResolution_m = 0.05;
constexpr int kPixels = 1200;
constexpr report::Color kAppeared{214, 39, 40};
constexpr report::Color kVanished{31, 119, 180};
constexpr std::array<report::Color, 6> kPaths{{{214, 39, 40},
                                               {31, 119, 180},
                                               {44, 160, 44},
                                               {255, 127, 14},
                                               {148, 103, 189},
                                               {23, 190, 207}}};

/// The level whose samples live longest, or shortest.
std::string extreme_level(const memory::TimescaleMemory& memory, bool longest) {
  const auto& levels = memory.config().levels;
  const auto slower = [](const auto& a, const auto& b) {
    return a.nominal_half_life_s() < b.nominal_half_life_s();
  };
  return (longest ? std::max_element(levels.begin(), levels.end(), slower)
                  : std::min_element(levels.begin(), levels.end(), slower))
      ->name;
}

std::vector<LevelPath> paths_of(const std::vector<std::pair<std::string, PathPlanner>>& planners,
                                const std::string& before, const Eigen::Vector2d& from_m,
                                const Eigen::Vector2d& to_m) {
  std::vector<LevelPath> paths;
  const Path* reference = nullptr;
  for (const auto& [level, planner] : planners) {
    paths.push_back({level, planner.plan(from_m, to_m), std::nullopt});
  }
  for (const LevelPath& path : paths) {
    if (path.level == before && path.path) reference = &*path.path;
  }
  for (LevelPath& path : paths) {
    if (reference != nullptr && path.path) path.frechet_m = frechet_m(*path.path, *reference);
  }
  return paths;
}

Json point(const Eigen::Vector2d& p) { return {p.x(), p.y()}; }

void frame(report::MapPicture& picture, const memory::ChangedPlace& place, report::Color color) {
  const Eigen::Vector2i a = picture.pixel(place.min_m);
  const Eigen::Vector2i b = picture.pixel(place.max_m);
  for (int line = 2; line <= 4; ++line) {
    picture.image.frame(a.x() - line, b.y() - line, b.x() + line, a.y() + line, color);
  }
}

void save(const std::filesystem::path& path, const report::MapPicture& picture) {
  report::write_file(path, report::encode_png(picture.image));
}

report::MapPicture draw_paths(const ReflectionGrid& map, const CellRect& rect,
                              const std::vector<LevelPath>& paths) {
  report::MapPicture picture = report::draw_map(map, rect, kPixels);
  for (std::size_t l = 0; l < paths.size(); ++l) {
    if (!paths[l].path) continue;
    std::vector<Pose2> poses;
    for (const Eigen::Vector2d& p : *paths[l].path) poses.push_back({p.x(), p.y(), 0.0});
    report::mark_trajectory(picture, poses, kPaths[l % kPaths.size()]);
  }
  return picture;
}

}  // namespace

LevelChanges level_changes(const memory::TimescaleMemory& memory, const NodeMap& map,
                           const LevelChangesTask& task) {
  LevelChanges changes;
  changes.before = task.before.empty() ? extreme_level(memory, true) : task.before;
  changes.now = task.now.empty() ? extreme_level(memory, false) : task.now;
  changes.places =
      memory::changed_places(map, map.level_index(changes.before), map.level_index(changes.now));
  if (task.paths.empty()) return changes;
  std::vector<std::pair<std::string, PathPlanner>> planners;
  for (const std::string& level : map.level_names()) {
    planners.emplace_back(level, PathPlanner(map.level_map(map.level_index(level), kResolution_m),
                                             task.robot_radius_m));
  }
  for (const auto& [from_m, to_m] : task.paths) {
    changes.paths.push_back(paths_of(planners, changes.before, from_m, to_m));
  }
  return changes;
}

Json to_json(const LevelChanges& changes, const LevelChangesTask& task) {
  Json json{{"before", changes.before}, {"now", changes.now}};
  json["places"] = maps::to_json(changes.places);
  json["paths"] = Json::array();
  for (std::size_t i = 0; i < changes.paths.size(); ++i) {
    Json levels = Json::array();
    for (const LevelPath& path : changes.paths[i]) {
      levels.push_back({{"level", path.level},
                        {"length_m", path.path ? Json(length_m(*path.path)) : Json(nullptr)},
                        {"frechet_m", path.frechet_m ? Json(*path.frechet_m) : Json(nullptr)}});
    }
    json["paths"].push_back({{"from", point(task.paths[i].first)},
                             {"to", point(task.paths[i].second)},
                             {"levels", std::move(levels)}});
  }
  return json;
}

void draw_level_changes(const std::filesystem::path& folder, const NodeMap& map,
                        const LevelChanges& changes, report::Drawings* drawings) {
  const auto add = [&](const std::string& name, const auto& drawn) {
    report::draw(drawings, folder / name, [&] { save(folder / name, drawn()); });
  };
  std::vector<ReflectionGrid> maps;
  for (std::size_t level = 0; level < map.level_names().size(); ++level) {
    maps.push_back(map.level_map(static_cast<int>(level), kResolution_m));
  }
  const auto map_of = [&](const std::string& level) -> const ReflectionGrid& {
    return maps[static_cast<std::size_t>(map.level_index(level))];
  };
  const CellRect rect = report::known_rect(map_of(changes.before));
  for (const std::string& level : map.level_names()) {
    add("level_" + level + ".png", [&] { return report::draw_map(map_of(level), rect, kPixels); });
  }
  add("changes.png", [&] {
    report::MapPicture picture = report::draw_map(map_of(changes.before), rect, kPixels);
    for (const memory::ChangedPlace& place : changes.places) {
      frame(picture, place, place.kind == memory::ChangeKind::kAppeared ? kAppeared : kVanished);
    }
    return picture;
  });
  for (std::size_t i = 0; i < changes.paths.size(); ++i) {
    add("path_" + std::to_string(i + 1) + ".png",
        [&] { return draw_paths(map_of(changes.now), rect, changes.paths[i]); });
  }
}

}  // namespace strata::pipeline
