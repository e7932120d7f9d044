// SPDX-License-Identifier: Apache-2.0
/// What a 3-D log says beside its clouds: where the robot was, and what its planar scanner saw
/// move.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "components/clouds/cloud_reader.hpp"
#include "core/base/config.hpp"
#include "core/base/progress.hpp"
#include "core/slam/slam.hpp"

namespace strata::pipeline {

/// How points on what moves are told.
enum class MovingKind {
  kAuto,    ///< both when the log has planar scans, else voxels; see resolve_moving
  kVoxels,  ///< EM on voxels
  kBoxes,   ///< boxes about dynamic planar beams
  kBoth,    ///< either says so
  kNone,
};

}  // namespace strata::pipeline

template <>
struct strata::EnumNames<strata::pipeline::MovingKind> {
  using Kind = strata::pipeline::MovingKind;
  static constexpr std::array<std::pair<Kind, const char*>, 5> values{{{Kind::kAuto, "auto"},
                                                                       {Kind::kVoxels, "voxels"},
                                                                       {Kind::kBoxes, "boxes"},
                                                                       {Kind::kBoth, "both"},
                                                                       {Kind::kNone, "none"}}};
};

namespace strata::pipeline {

struct VolumeSources {
  clouds::CloudReadOptions reading;  ///< with the robot's poses, where they are not tf's
  std::string pose_source;           ///< "poses", "tf", "slam" or "log"
  bool uses_voxels = false;
  bool uses_boxes = false;
  /// Planar scans with poses and labels; empty unless boxes or colours are made from them.
  std::vector<PosedScan> scans;
  std::vector<std::string> warnings;
};

/// What kAuto stands for. Where change is to be remembered, boxes alone: on voxels a thing that is
/// put down in the course of a log counts as moving, and would be left out.
[[nodiscard]] MovingKind resolve_moving(MovingKind moving, bool has_scans, bool remember);

/// Poses: from `poses` (TUM or what --poses reads; map_from_robot) when given; else tf's when it
/// knows the frame map; else from planar SLAM when the bag has scans; else tf's odometry. Labels of
/// beams: of the same SLAM. Throws InputError when boxes are asked of a log without planar scans,
/// or poses given for a log that has its own; Cancelled.
[[nodiscard]] VolumeSources find_volume_sources(const std::filesystem::path& log,
                                                const std::string& poses, MovingKind moving,
                                                bool remember, const slam::SlamConfig& slam,
                                                int threads, Progress* progress);

}  // namespace strata::pipeline
