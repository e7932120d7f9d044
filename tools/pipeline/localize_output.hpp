// SPDX-License-Identifier: Apache-2.0
/// The files of a localization run: trajectory.tum, states.csv, metrics.json.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include <nlohmann/json.hpp>

#include "tools/pipeline/cost.hpp"
#include "tools/pipeline/localize.hpp"

namespace strata::pipeline {

struct LogFit;

struct LocalizeSummary {
  std::string model;
  std::uint64_t seed = 1;
  int particles = 0;  ///< as configured
  Cost cost;
  std::optional<Pose2> map_from_truth;  ///< the alignment that errors were measured with
};

/// Fills in the error fields, and with what alignment they were measured; leaves them null when
/// there is no error.
void add_errors(nlohmann::json& metrics, std::span<const ScanError> errors,
                const std::optional<Pose2>& map_from_truth);

/// What is told of whether the maps explain the log: shares of the weighed scans.
[[nodiscard]] nlohmann::json map_fit_json(const LogFit& fit);

/// Writes into an existing folder and returns the metrics; error fields are null when no truth was
/// known, and without `fit` nothing is said of it. Throws OutputError.
nlohmann::json write_localization(const std::filesystem::path& folder, const LocalizationRun& run,
                                  const LocalizeSummary& summary, const LogFit* fit = nullptr);

}  // namespace strata::pipeline
