// SPDX-License-Identifier: Apache-2.0
/// The parts of summary.json, as the contracts name them.
#pragma once

#include <span>

#include <nlohmann/json.hpp>

#include "components/log/log_reader.hpp"
#include "core/patch/patch_map.hpp"
#include "core/slam/slam.hpp"
#include "memory/nodes/timescale_memory.hpp"

namespace strata::maps {

/// {"scans", "duration_s", "path_m", "runs", "skipped_scans", "consistency": {"consistent",
/// "compared", "contradicting", "runs_against_others", "places": [{"x", "y", "why"}]}
/// (core/slam/consistency.hpp),
/// "drop_outs": {"judged", "dropped", "returned", "free_range_m"} (core/scan/drop_outs.hpp),
/// "sharpness": {...} of the map of all beams (core/grid/map_sharpness.hpp), "em": {...}}.
/// duration_s adds up the runs; path_m adds steps of at least 0.1 m, so that the jitter of a
/// standing robot does not count.
[[nodiscard]] nlohmann::json summarize_slam(const slam::SlamResult& result);

/// The array "submaps".
[[nodiscard]] nlohmann::json summarize_patch_map(const patch::PatchMap& map);

/// The array "unrecurring": the rectangles [x0, y0, x1, y1] in metres of areas that change but show
/// nothing again, which the map leaves out.
[[nodiscard]] nlohmann::json summarize_unrecurring(const patch::PatchMap& map);

/// The object "timescale".
[[nodiscard]] nlohmann::json summarize_timescale(const memory::TimescaleMemory& memory);

/// What was taken for no return, one entry a scanner: [{"from_m", "why", "scanner" where there are
/// several}].
[[nodiscard]] nlohmann::json summarize_no_returns(const log::ReadReport& report);

/// What reading the logs found: {"no_return": [...], "odometry_lag_s": of the log, null where it
/// does not tell; an array of them, one a log, where there are several}.
[[nodiscard]] nlohmann::json summarize_reading(std::span<const log::ReadReport> reports);

}  // namespace strata::maps
