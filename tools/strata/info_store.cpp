// SPDX-License-Identifier: Apache-2.0
/// `strata info strata.db`: what a store holds, and how large each part is.
#include "tools/strata/info_store.hpp"

#include <cstdio>
#include <iostream>

#include <nlohmann/json.hpp>

#include "components/log/json_text.hpp"
#include "memory/store/store_summary.hpp"

namespace strata::tools {
namespace {

using Json = nlohmann::ordered_json;

Json describe(const std::string& path, const memory::StoreSummary& store) {
  Json info;
  info["store"] = path;
  info["version"] = store.version;
  info["bytes"] = store.file_bytes;
  info["grids"] = Json::array();
  for (const auto& grid : store.grids) {
    info["grids"].push_back({{"name", grid.name},
                             {"resolution_m", grid.resolution_m},
                             {"width_m", grid.width_m},
                             {"height_m", grid.height_m},
                             {"bytes", grid.bytes}});
  }
  info["patch_maps"] = Json::array();
  for (const auto& map : store.patch_maps) {
    info["patch_maps"].push_back({{"name", map.name},
                                  {"submaps", map.submaps},
                                  {"configurations", map.configurations},
                                  {"sequences", map.sequences},
                                  {"submaps_by_time", map.in_time}});
  }
  info["runs"] = Json::array();
  for (const auto& run : store.runs) {
    info["runs"].push_back(
        {{"run", run.run}, {"poses", run.poses}, {"scans", run.scans}, {"scan_bytes", run.bytes}});
  }
  info["timescale"] = Json::array();
  for (const auto& memory : store.timescales) {
    Json levels = Json::array();
    for (const auto& level : memory.levels) {
      levels.push_back({{"name", level.name},
                        {"half_life_s", level.half_life_s},
                        {"samples", level.samples},
                        {"pairs", level.pairs},
                        {"bytes", level.bytes},
                        {"most_bytes_a_node", level.max_bytes_a_node}});
    }
    info["timescale"].push_back({{"name", memory.name},
                                 {"nodes", memory.nodes},
                                 {"observations", memory.observations},
                                 {"levels", levels}});
  }
  info["texts"] = store.texts;
  return info;
}

std::string size_text(std::int64_t bytes) { return kilobytes(static_cast<std::uintmax_t>(bytes)); }

std::string metres(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f m", value);
  return text;
}

std::string duration(double seconds) {
  char text[32];
  const bool is_days = seconds >= 86400.0;
  std::snprintf(text, sizeof text, is_days ? "%.3g days" : "%.3g s",
                is_days ? seconds / 86400.0 : seconds);
  return text;
}

void print(const std::string& path, const memory::StoreSummary& store) {
  std::cout << path << ": Strata store, version " << store.version << ", "
            << size_text(store.file_bytes) << "\n";
  for (const auto& grid : store.grids) {
    std::cout << "  grid       " << grid.name << ", " << metres(grid.width_m) << " x "
              << metres(grid.height_m) << " at " << grid.resolution_m << " m, "
              << size_text(grid.bytes) << "\n";
  }
  for (const auto& map : store.patch_maps) {
    std::cout << "  patch map  " << map.name << ", " << map.submaps << " sub-maps, "
              << map.configurations << " configurations, " << map.sequences << " sequences"
              << (map.in_time > 0 ? ", " + std::to_string(map.in_time) + " by time of day" : "")
              << "\n";
  }
  for (const auto& run : store.runs) {
    std::cout << "  run        " << run.run << ", " << run.poses << " poses, " << run.scans
              << " scans kept, " << size_text(run.bytes) << "\n";
  }
  for (const auto& memory : store.timescales) {
    std::cout << "  timescale  " << memory.name << ", " << memory.nodes << " nodes, "
              << memory.observations << " scans taken in\n";
    for (const auto& level : memory.levels) {
      std::cout << "    level    " << level.name;
      if (level.half_life_s > 0.0) std::cout << ", half-life " << duration(level.half_life_s);
      std::cout << ", " << level.samples << " samples, " << level.pairs << " pairs, "
                << size_text(level.bytes) << ", at most " << size_text(level.max_bytes_a_node)
                << " a node\n";
    }
  }
  for (const auto& key : store.texts) std::cout << "  text       " << key << "\n";
}

}  // namespace

std::string kilobytes(std::uintmax_t bytes) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f kB", static_cast<double>(bytes) / 1000.0);
  return text;
}

Json describe_store(const std::string& path) {
  return describe(path, memory::summarize_store(path));
}

void print_store(const std::string& path, bool json) {
  if (json) {
    std::cout << log::json_text(describe_store(path));
  } else {
    print(path, memory::summarize_store(path));
  }
}

}  // namespace strata::tools
