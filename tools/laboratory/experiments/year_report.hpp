// SPDX-License-Identifier: Apache-2.0
/// The days of a simulated year as a table, plots and sums.
#pragma once

#include <filesystem>
#include <fstream>
#include <vector>

#include "tools/laboratory/experiments/year.hpp"

namespace strata::experiments {

class YearReport {
 public:
  /// Begins year.csv in the folder.
  explicit YearReport(std::filesystem::path folder);
  /// A row, written at once: a year that is cut short leaves its days. Prints every tenth.
  void add(const YearDay& day);
  /// Prints the sums as a Markdown table and writes year_error.png and year_size.png.
  void finish() const;

 private:
  void print_sums() const;
  void draw() const;

  std::filesystem::path folder_;
  std::ofstream csv_;
  std::vector<YearDay> days_;
};

}  // namespace strata::experiments
