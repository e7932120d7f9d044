// SPDX-License-Identifier: Apache-2.0
/// report.html of a comparison, with every figure beside it as PNG and CSV.
#pragma once

#include <filesystem>
#include <string>

#include "tools/pipeline/compare.hpp"

namespace strata::pipeline {

/// Writes report.html, the figures, errors.csv (model, seed, time, error) and comparison.json into
/// an existing folder. settings: the configuration as text, for the fine print. Throws OutputError.
void write_report(const CompareOutcome& outcome, const std::string& settings,
                  const std::filesystem::path& folder);

/// Writes errors.csv (every scan of every run) and predictions.csv (the held-out fit, scan by
/// scan).
void write_series(const Comparison& comparison, const std::filesystem::path& folder);

}  // namespace strata::pipeline
