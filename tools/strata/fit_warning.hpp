// SPDX-License-Identifier: Apache-2.0
/// What is told of a log that its maps do not explain.
#pragma once

#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "tools/pipeline/map_fit.hpp"

namespace strata::tools {

/// With a lower score in the mean most poses are wrong, however much of each scan fits.
inline constexpr double kMinMeanScore = 0.3;

/// Of a log that was localized.
struct LocalizedLog {
  const pipeline::LogFit& fit;  ///< without scans: nobody could look
  std::optional<double> mean_score;
  std::string model;
  std::string begin;  ///< what said where the robot began; empty: a global start
};

/// For who took another building's log, or another pose to begin with: "these maps do not explain
/// this log" and why; empty when they do. The score was learned with grid and patch maps: of a
/// timescale memory it is told, and warns of nothing.
[[nodiscard]] std::string fit_warning(const LocalizedLog& log);

/// For who said where the robot began (`begin`): the first of the `relocations` of metrics.json
/// came before any scan had spoken for that place. Empty where none did.
[[nodiscard]] std::string start_warning(const nlohmann::json& relocations,
                                        const std::string& begin);

/// For who compares with a truth in a frame of its own: the maps explain the log, and the poses lie
/// more than a metre off in the mean. Empty where maps were told where the truth lies
/// (`is_frame_known`), or where nothing is odd.
[[nodiscard]] std::string frame_warning(const pipeline::LogFit& fit, std::optional<double> error_m,
                                        bool is_frame_known);

}  // namespace strata::tools
