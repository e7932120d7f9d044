// SPDX-License-Identifier: Apache-2.0
/// report.html of a comparison, with every figure beside it as PNG and CSV.
#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

#include "tools/pipeline/compare.hpp"
#include "tools/report/html_report.hpp"

namespace strata::pipeline {

/// Writes report.html, the figures, errors.csv (model, seed, time, error) and comparison.json into
/// an existing folder. settings: the configuration as text, for the fine print. drawings: told of
/// pictures that cannot be drawn; null: they throw. Throws OutputError.
void write_report(const CompareOutcome& outcome, const std::string& settings,
                  const std::filesystem::path& folder, report::Drawings* drawings = nullptr);

/// What every report ends with: the fine print, errors.csv and predictions.csv, and `result` as
/// comparison.json. Throws OutputError.
void finish_report(const Comparison& comparison, const nlohmann::json& result,
                   const std::string& settings, const std::filesystem::path& folder,
                   report::HtmlReport& page);

/// Writes errors.csv (every scan of every run) and predictions.csv (the held-out fit, scan by
/// scan).
void write_series(const Comparison& comparison, const std::filesystem::path& folder);

}  // namespace strata::pipeline
