// SPDX-License-Identifier: Apache-2.0
/// The way of a localized robot in the map.
#pragma once

#include <filesystem>

#include "core/grid/reflection_grid.hpp"
#include "tools/pipeline/map_fit.hpp"
#include "tools/report/image.hpp"

namespace strata::pipeline {

inline constexpr const char* kTrajectoryPicture = "trajectory.png";

/// The colour of a scan: from red (no beam ends where the map has it end) over yellow to green
/// (all do); blue where the map knows too little; purple where several
/// places were possible.
[[nodiscard]] report::Color color_of(const FittedScan& scan);

/// Writes trajectory.png into an existing folder: the map with a dot for each scan, and a larger
/// one for each place that is still possible at the end. Throws
/// OutputError.
void write_trajectory_picture(const std::filesystem::path& folder, const ReflectionGrid& map,
                              const LogFit& fit);

}  // namespace strata::pipeline
