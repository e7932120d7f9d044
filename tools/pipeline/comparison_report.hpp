// SPDX-License-Identifier: Apache-2.0
/// report.html of a comparison, with every figure beside it as PNG and CSV.
#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

#include "tools/pipeline/compare.hpp"
#include "tools/report/html_report.hpp"

namespace strata::pipeline {

/// Of the maps of the first split, as parts of a page; the files lie in some folder.
struct MapFigures {
  std::string grids_and_patches;
  std::string timescale;
};
/// Draws them, and writes their files into the folder. Throws OutputError.
[[nodiscard]] MapFigures draw_maps(const LearnResult& learned, const maps::Maps& maps,
                                   const std::filesystem::path& folder,
                                   report::Drawings* drawings = nullptr);

/// Writes report.html, the figures, errors.csv (model, seed, time, error) and comparison.json into
/// an existing folder. settings: the configuration as text, for the fine print. drawings: told of
/// pictures that cannot be drawn; null: they throw. Throws OutputError.
void write_report(const CompareOutcome& outcome, const std::string& settings,
                  const std::filesystem::path& folder, report::Drawings* drawings = nullptr);

/// The same with figures that were drawn before; their files are to lie in the folder, too.
void write_report(const Comparison& comparison, const MapFigures& figures,
                  const std::string& settings, const std::filesystem::path& folder,
                  report::Drawings* drawings = nullptr);

/// What every report ends with: the fine print, errors.csv and predictions.csv, and `result` as
/// comparison.json. Throws OutputError.
void finish_report(const Comparison& comparison, const nlohmann::json& result,
                   const std::string& settings, const std::filesystem::path& folder,
                   report::HtmlReport& page);

/// Writes errors.csv (every scan of every run) and predictions.csv (the held-out fit, scan by
/// scan).
void write_series(const Comparison& comparison, const std::filesystem::path& folder);

}  // namespace strata::pipeline
