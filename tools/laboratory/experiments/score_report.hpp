// SPDX-License-Identifier: Apache-2.0
/// Whether the localizer's score is what it says, on worlds and logs; and weights learned from
/// them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace strata::experiments {

struct ScoreReportOptions {
  std::vector<std::string> logs;   ///< maps of the first 60% of each
  std::vector<std::string> poses;  ///< one a log
  std::string runs;                ///< folder of the three runs of Wean Hall; empty: without
  std::string scenarios;           ///< folder of scenario files
  std::vector<std::string> scenario_names;  ///< of several days, in that folder
  std::uint64_t first_office = 1;
  int offices = 20;  ///< every other one with a scanner of 4 m
  std::filesystem::path out;
};

/// Prints for each group (offices, each scenario, each log, the runs) and model how many scans have
/// a score of 0.9 or more, what share of those is wrong, and how many right poses are called lost;
/// writes reliability.png and reliability.csv (ScoreReportOptions::out); and prints the weights
/// that fit_score() learns from all groups.
void report_score(const ScoreReportOptions& options);

}  // namespace strata::experiments
