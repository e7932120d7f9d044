// SPDX-License-Identifier: Apache-2.0
/// How much of a scan a patch map explains from one pose.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/pose2.hpp"
#include "core/localization/inlier_shares.hpp"
#include "core/localization/laser_columns.hpp"
#include "core/localization/patch_states.hpp"
#include "core/patch_beams/beam_ends.hpp"
#include "core/patch_beams/patch_ray_caster.hpp"

namespace strata::patch_beams {

/// Working memory of explain_beams(). Allocates nothing once warm.
struct ExplanationMemory {
  localization::LaserColumns lasers;
  std::vector<double> range_m;  // of each beam, where it ends for certain
  std::vector<std::int32_t> cells;
  std::vector<double> static_m;  // the same in rows of one entry a laser
  ChangingEnds changing;
  std::vector<RayEvent> events;  // of one beam
  std::vector<double> values;
};

/// Shares of the beams in use that each map which `belief` holds possible explains, weighed by its
/// probability. map_from_laser: the pose of the laser. current: the sub-map that the robot is in,
/// -1: none. belief: one row, as PatchStates lays it out. No beams: all shares are 0.
[[nodiscard]] localization::InlierShares explain_beams(const PreparedScan& scan,
                                                       const PatchRayCaster& caster,
                                                       const localization::PatchStates& layout,
                                                       const Pose2& map_from_laser, int current,
                                                       std::span<const float> belief,
                                                       ExplanationMemory& memory);

}  // namespace strata::patch_beams
