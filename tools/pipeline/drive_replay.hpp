// SPDX-License-Identifier: Apache-2.0
/// A drive to be looked at again: one page with a slider through time, which opens offline.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "components/maps/localization_files.hpp"
#include "core/geometry/pose2.hpp"
#include "core/grid/reflection_grid.hpp"
#include "core/patch/patch_map.hpp"
#include "core/scan/scan.hpp"

namespace strata::pipeline {

inline constexpr const char* kReplayPage = "replay.html";
/// No page is larger [bytes]; scans are left out until it is not.
inline constexpr std::size_t kReplayBudget = 5'000'000;
/// At most so many scans of a drive are shown, evenly, ...
inline constexpr std::size_t kReplayScans = 1500;
/// ... and so many hits of each.
inline constexpr std::size_t kReplayBeams = 90;

/// One localizer's way through the drive; each has a panel of its own.
struct ReplayTrack {
  std::string name;
  std::span<const log::StampedPose> trajectory;  ///< map_from_robot, one an observation
  std::span<const maps::StateRow> states;        ///< in the order of the observations; may be empty
  std::span<const double> scores;                ///< one an observation; may be empty
  const patch::PatchMap* patches = nullptr;      ///< where `states` are; null: none
  std::span<const float> particles = {};         ///< LocalizationRun::shown_particles; may be empty
};

struct DriveReplay {
  const ReflectionGrid& map;
  std::span<const Observation> observations;
  std::span<const std::optional<Pose2>> truths;  ///< empty, or map_from_robot of each where known
  std::vector<ReplayTrack> tracks;
};

/// The page, packed into the program; DRIVE_DATA stands where the data go.
[[nodiscard]] std::string_view replay_template();

/// The whole page: millimetres, milliradians and centimetres in JSON, the map as PNG. Throws
/// OutputError when not even a few scans fit into `budget`. O(scans shown x beams + map cells).
[[nodiscard]] std::string replay_page(const DriveReplay& drive, std::size_t budget = kReplayBudget);

/// Writes replay.html into an existing folder. Throws OutputError.
void write_replay(const std::filesystem::path& folder, const DriveReplay& drive);

}  // namespace strata::pipeline
