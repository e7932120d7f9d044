// SPDX-License-Identifier: Apache-2.0
/// The MAPS folder: what learning leaves behind and localization starts from.
///
/// The parts are written one by one, each by whoever learned it, into strata.db and the files
/// beside it; the direct path and the DDS components call the same functions, so both leave the
/// same bytes.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "components/maps/timescale_use.hpp"
#include "core/base/progress.hpp"
#include "core/grid/surface_layer.hpp"
#include "core/patch/patch_map.hpp"
#include "core/slam/slam.hpp"
#include "memory/decoding/decoding_config.hpp"
#include "memory/nodes/timescale_memory.hpp"
#include "memory/store/store.hpp"

namespace strata::rays {
class RayCaster;
}

namespace strata::maps {

/// The names inside MAPS that the contracts fix.
inline constexpr const char* kStoreFile = "strata.db";
inline constexpr const char* kSummaryFile = "summary.json";
inline constexpr const char* kTrajectoryFile = "trajectory.tum";

/// Writes occupancy.{yaml,pgm}, filtered.{yaml,pgm}, trajectory.tum, and the grids, counts,
/// trajectories and scans of strata.db. Creates `dir`. Throws OutputError.
void write_grid_maps(const std::filesystem::path& dir, const slam::SlamResult& result);

/// Writes patches.pgm (base with the likeliest configuration everywhere), patches/ with a
/// map_server pair per configuration of each sub-map, and the patch map of strata.db.
void write_patch_map(const std::filesystem::path& dir, const patch::PatchMap& map);

/// Writes the timescale memory of strata.db and the description of its levels.
void write_timescale(const std::filesystem::path& dir, const memory::TimescaleMemory& memory);

/// The rigid motion from the frame of the ground truth to the map frame, estimated while learning.
void write_map_from_truth(const std::filesystem::path& dir, const Pose2& map_from_truth);

/// What a job cost, for the summary.
struct JobCost {
  double wall_s = 0.0;
  double cpu_s = 0.0;
  double peak_rss_mb = 0.0;
};
/// Composes summary.json from what the parts left in strata.db, and returns it. Last step of
/// learning. reading: what else there is to say of the logs (summarize_reading).
nlohmann::json write_summary(const std::filesystem::path& dir, const std::string& log,
                             const JobCost& cost,
                             const nlohmann::json& reading = nlohmann::json::object());

/// Everything that a MAPS folder holds; parts that were not learned are empty.
struct Maps {
  ReflectionGrid occupancy;
  ReflectionGrid filtered;
  SurfaceLayer surfaces;  ///< in the cells of `filtered`; empty in folders of before
  std::optional<patch::PatchMap> patches;
  /// ... whose sub-maps follow the places of a topology; made by comparisons, in no folder.
  std::optional<patch::PatchMap> place_patches;
  std::shared_ptr<const memory::TimescaleMemory> timescale;
  /// How `timescale` becomes what it expects; said by whoever localizes, in no folder.
  memory::DecodingConfig decoding;
  /// What `timescale` expects, when a snapshot was made already, or where only that is known, as of
  /// maps that came over DDS; null: made when needed.
  std::shared_ptr<const memory::NodeMap> nodes;
  /// ... and is used; the same.
  TimescaleUseConfig timescale_use;
  /// Casts beams in `filtered`; null: made when needed.
  std::shared_ptr<const rays::RayCaster> filtered_caster;
  std::optional<Pose2> map_from_truth;
  /// Calls with each scan that the maps were learned from, at its pose, run by run; empty: they are
  /// not kept. Those of a folder are read when it is called, and must still be there; those of a
  /// LearnResult are its own.
  std::function<void(const std::function<void(const PosedScan&)>& visit)> visit_scans;
  /// A map that was not learned here (a map_server file), and where it lies.
  ReflectionGrid given;
  Pose2 given_from_map;
};

/// A part of Maps that models are made of (components/maps/map_models.hpp).
enum class MapPart {
  kOccupancy,
  kFiltered,
  kPatches,
  kPlacePatches,
  kTimescale,  ///< the memory, or only what it expects
  kScans,
  kGiven,
};

/// Where a part can come from.
struct MapPartInfo {
  const char* name = "";          ///< for people
  bool is_learned = true;         ///< else somebody gives it
  bool is_in_folder = true;       ///< a MAPS folder holds it
  const char* message = nullptr;  ///< that brings it over a topic; null: none does
};
[[nodiscard]] const MapPartInfo& info_of(MapPart part);

/// Whether these maps hold that part.
[[nodiscard]] bool has(const Maps& maps, MapPart part);

/// The store of a MAPS folder. Throws InputError when strata.db is missing or damaged.
[[nodiscard]] memory::Store open_for_reading(const std::filesystem::path& dir);

/// What write_map_from_truth left; nothing when there was no truth.
[[nodiscard]] std::optional<Pose2> read_map_from_truth(const memory::Store& store);

/// Reads a MAPS folder. Throws InputError when strata.db is missing or damaged.
[[nodiscard]] Maps read_maps(const std::filesystem::path& dir);

}  // namespace strata::maps
