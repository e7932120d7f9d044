// SPDX-License-Identifier: Apache-2.0
#include "components/maps/maps_folder.hpp"

#include <algorithm>
#include <cstddef>
#include <fstream>
#include <iterator>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "components/log/json_text.hpp"
#include "components/log/map_file.hpp"
#include "components/log/trajectory_file.hpp"
#include "components/maps/summary.hpp"
#include "core/base/error.hpp"
#include "core/patch/expected_next.hpp"
#include "memory/store/store.hpp"

namespace strata::maps {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

constexpr const char* kSlamKey = "summary/slam";
constexpr const char* kPatchKey = "summary/submaps";
constexpr const char* kUnrecurringKey = "summary/unrecurring";
constexpr const char* kTimescaleKey = "summary/timescale";
constexpr const char* kTruthKey = "map_from_truth";
constexpr const char* kOccupancyGrid = "occupancy";
constexpr const char* kFilteredGrid = "filtered";
constexpr const char* kCountsGrid = "counts";

/// In order. Copied into `room` only where another run's lie between them.
std::span<const PosedScan> scans_of_run(std::span<const PosedScan> scans, int run,
                                        std::vector<PosedScan>& room) {
  const auto is_of_run = [run](const PosedScan& scan) { return scan.run == run; };
  const auto begin = std::find_if(scans.begin(), scans.end(), is_of_run);
  const auto end = std::find_if_not(begin, scans.end(), is_of_run);
  if (std::none_of(end, scans.end(), is_of_run)) return {begin, end};
  std::copy_if(begin, scans.end(), std::back_inserter(room), is_of_run);
  return room;
}

memory::Store open_for_writing(const fs::path& dir) {
  std::error_code error;
  fs::create_directories(dir, error);
  if (error) {
    throw OutputError(dir.string(), "cannot be created: " + error.message(),
                      "choose another folder or mend its permissions");
  }
  return memory::Store(dir / kStoreFile);
}

void write_text(const fs::path& path, const std::string& text) {
  std::ofstream out(path);
  out << text;
  out.close();
  if (!out)
    throw OutputError(path.string(), "cannot be written", "check the folder and free space");
}

struct PartRow {
  MapPart part;
  MapPartInfo info;
  bool (*is_in)(const Maps&);
};

const PartRow& row_of(MapPart part) {
  static const PartRow rows[] = {
      {MapPart::kOccupancy,
       {"the occupancy grid", true, true, "nav_msgs/OccupancyGrid"},
       [](const Maps& maps) { return maps.occupancy.size() > 0; }},
      {MapPart::kFiltered,
       {"the filtered grid", true, true, "strata_msgs/ReflectionGrid"},
       [](const Maps& maps) { return maps.filtered.size() > 0; }},
      {MapPart::kPatches,
       {"the patch map", true, true, "strata_msgs/PatchMap"},
       [](const Maps& maps) { return maps.patches.has_value(); }},
      {MapPart::kPlacePatches,
       {"a patch map by places", true, false, nullptr},
       [](const Maps& maps) { return maps.place_patches.has_value(); }},
      {MapPart::kTimescale,
       {"the timescale memory", true, true, "strata_msgs/NodeMap"},
       [](const Maps& maps) { return maps.timescale != nullptr || maps.nodes != nullptr; }},
      {MapPart::kScans,
       {"the scans", true, true, nullptr},
       [](const Maps& maps) { return static_cast<bool>(maps.visit_scans); }},
      {MapPart::kGiven,
       {"a map_server map", false, false, nullptr},
       [](const Maps& maps) { return maps.given.size() > 0; }},
  };
  return *std::find_if(std::begin(rows), std::end(rows),
                       [&](const PartRow& row) { return row.part == part; });
}

json part(const memory::Store& store, const char* key, json otherwise) {
  const auto text = store.find_text(key);
  return text ? json::parse(*text) : std::move(otherwise);
}

}  // namespace

void write_grid_maps(const fs::path& dir, const slam::SlamResult& result) {
  memory::Store store = open_for_writing(dir);
  log::write_map(dir / "occupancy.yaml", result.occupancy);
  log::write_map(dir / "filtered.yaml", result.filtered);

  std::map<int, std::vector<memory::TrajectoryPose>> runs;
  std::vector<log::StampedPose> all;
  for (const PosedScan& scan : result.scans) {
    runs[scan.run].push_back({scan.scan.stamp, scan.map_from_robot, std::nullopt});
    all.push_back({scan.scan.stamp, scan.map_from_robot});
  }
  log::write_trajectory(dir / kTrajectoryFile, all);
  store.transaction([&] {
    store.save_grid(kOccupancyGrid, result.occupancy);
    store.save_grid(kFilteredGrid, result.filtered);
    store.save_surfaces(kFilteredGrid, result.surfaces);
    store.save_grid(kCountsGrid, result.raw.cells());
    for (const auto& [run, poses] : runs) store.save_trajectory(run, poses);
    for (const auto& [run, poses] : runs) {
      std::vector<PosedScan> room;
      store.save_scans(run, scans_of_run(result.scans, run, room));
    }
    store.save_text(kSlamKey, summarize_slam(result).dump());
  });
}

void write_patch_map(const fs::path& dir, const patch::PatchMap& map) {
  memory::Store store = open_for_writing(dir);
  log::write_map(dir / "patches.yaml", patch::compose(map, patch::expected_next(map)));
  const fs::path folder = dir / "patches";
  fs::create_directories(folder);
  for (const patch::Submap& submap : map.submaps) {
    for (std::size_t c = 0; c < submap.configurations.size(); ++c) {
      const std::string name =
          "submap" + std::to_string(submap.id) + "_configuration" + std::to_string(c) + ".yaml";
      log::write_map(folder / name, submap.configurations[c].reflection);
    }
  }
  store.transaction([&] {
    store.save_patch_map(map);
    store.save_text(kPatchKey, summarize_patch_map(map).dump());
    store.save_text(kUnrecurringKey, summarize_unrecurring(map).dump());
  });
}

void write_timescale(const fs::path& dir, const memory::TimescaleMemory& memory) {
  memory::Store store = open_for_writing(dir);
  store.transaction([&] {
    store.save_timescale(memory);
    store.save_text(kTimescaleKey, summarize_timescale(memory).dump());
  });
}

void write_map_from_truth(const fs::path& dir, const Pose2& map_from_truth) {
  memory::Store store = open_for_writing(dir);
  store.save_text(kTruthKey, json{map_from_truth.x, map_from_truth.y, map_from_truth.theta}.dump());
}

json write_summary(const fs::path& dir, const std::string& log, const JobCost& cost,
                   const json& reading) {
  const memory::Store store(dir / kStoreFile, {.read_only = true, .check = false});
  json summary = part(store, kSlamKey, json::object());
  summary["kind"] = "maps";
  summary["log"] = log;
  summary.update(reading);
  summary["submaps"] = part(store, kPatchKey, json::array());
  summary["unrecurring"] = part(store, kUnrecurringKey, json::array());
  summary["timescale"] = part(store, kTimescaleKey, nullptr);
  const double duration_s = summary.value("duration_s", 0.0);
  summary["cost"] = {{"wall_s", cost.wall_s},
                     {"cpu_s", cost.cpu_s},
                     {"real_time_factor", cost.wall_s > 0.0 ? duration_s / cost.wall_s : 0.0},
                     {"peak_rss_mb", cost.peak_rss_mb}};
  write_text(dir / kSummaryFile, log::json_text(summary));
  return summary;
}

const MapPartInfo& info_of(MapPart part) { return row_of(part).info; }

bool has(const Maps& maps, MapPart part) { return row_of(part).is_in(maps); }

memory::Store open_for_reading(const fs::path& dir) {
  std::error_code error;
  if (!fs::exists(dir / kStoreFile, error)) {
    throw InputError((dir / kStoreFile).string(), "is missing",
                     "give a folder that `strata learn` wrote");
  }
  return memory::Store(dir / kStoreFile, {.read_only = true});
}

std::optional<Pose2> read_map_from_truth(const memory::Store& store) {
  const json pose = part(store, kTruthKey, nullptr);
  if (!pose.is_array()) return std::nullopt;
  return Pose2{pose[0], pose[1], pose[2]};
}

Maps read_maps(const fs::path& dir) {
  const memory::Store store = open_for_reading(dir);
  Maps maps;
  if (store.has_grid(kOccupancyGrid)) maps.occupancy = store.load_reflection_grid(kOccupancyGrid);
  if (store.has_grid(kFilteredGrid)) maps.filtered = store.load_reflection_grid(kFilteredGrid);
  maps.surfaces = store.load_surfaces(kFilteredGrid);
  if (store.has_patch_map()) maps.patches = store.load_patch_map();
  if (store.has_timescale()) {
    maps.timescale = std::make_shared<const memory::TimescaleMemory>(store.load_timescale());
  }
  maps.map_from_truth = read_map_from_truth(store);
  if (!store.runs_with_scans().empty()) {
    maps.visit_scans = [dir](const std::function<void(const PosedScan&)>& visit) {
      const memory::Store reopened = open_for_reading(dir);
      for (const int run : reopened.runs_with_scans()) {
        for (const PosedScan& scan : reopened.load_scans(run)) visit(scan);
      }
    };
  }
  return maps;
}

}  // namespace strata::maps
