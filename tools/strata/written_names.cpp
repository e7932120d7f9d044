// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/written_names.hpp"

#include <algorithm>
#include <system_error>

#include <fnmatch.h>

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

constexpr const char* kMaps[] = {"occupancy.*", "filtered.*",     "patches",     "patches.*",
                                 "plan.*",      "pictures",       "strata.db*",  "map.png",
                                 "dynamic.png", "trajectory.tum", "summary.json"};
constexpr const char* kLocalization[] = {"trajectory.*", "replay.html",  "refined.tum",
                                         "states.csv",   "metrics.json", "summary.json"};
constexpr const char* kTopology[] = {"topologies.*", "topology.graphml", "places.yaml",
                                     "occupancy.*",  "trajectory.tum",   "landmarks.png",
                                     "odometry.png", "map.png",          "summary.json"};
constexpr const char* kComparison[] = {"comparison.json", "report.html", "replay.html",
                                       "*.csv",           "*.png",       "*.svg",
                                       "[0-9]*_*",        "summary.json"};
constexpr const char* kVolume[] = {"map.bt",      "map.ot",       "map_color.ot",
                                   "*.png",       "textured.glb", "slice_*",
                                   "report.html", "changes.json", "summary.json"};
constexpr const char* kChanges[] = {"changes.json", "changes.png", "level_*.png", "path_*.png",
                                    "summary.json"};
constexpr const char* kSimulation[] = {"log.clf",     "bag",       "truth.tum",   "day_*",
                                       "states.json", "world.png", "summary.json"};
constexpr const char* kMessages[] = {"package.xml", "CMakeLists.txt", "msg"};

}  // namespace

std::span<const char* const> written_names(std::string_view kind) {
  if (kind == "maps") return kMaps;
  if (kind == "localization") return kLocalization;
  if (kind == "topology") return kTopology;
  if (kind == "comparison") return kComparison;
  if (kind == "volume") return kVolume;
  if (kind == "changes") return kChanges;
  if (kind == "simulation") return kSimulation;
  if (kind == "messages") return kMessages;
  return {};
}

std::string entry_in_the_way(const fs::path& folder, std::string_view kind) {
  const std::span<const char* const> names = written_names(kind);
  std::string first;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    const bool is_written = std::any_of(names.begin(), names.end(), [&](const char* pattern) {
      return fnmatch(pattern, name.c_str(), 0) == 0;
    });
    if (is_written && (first.empty() || name < first)) first = name;
  }
  return first;
}

}  // namespace strata::tools
