// SPDX-License-Identifier: Apache-2.0
/// Comparisons of several buildings, in one table.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/pipeline/comparison.hpp"

namespace strata::pipeline {

/// One building, compared by itself; its own report lies in `folder`, below the joint one.
struct Building {
  std::string folder;
  Comparison comparison;
};

/// All drives of all buildings as one comparison: units are (drive, seed), sizes are sums. Without
/// memory curves and traces of states, which belong to one map. Throws InputError when the models
/// differ. Requires at least one.
[[nodiscard]] Comparison join(const std::vector<Building>& buildings);

/// Writes report.html, comparison.json (the joint one, with the buildings' own below `buildings`)
/// and errors.csv into the folder. Throws OutputError.
void write_joint_report(const std::vector<Building>& buildings, const std::string& settings,
                        const std::filesystem::path& folder);

/// What write_joint_report puts into comparison.json.
[[nodiscard]] nlohmann::json joint_json(const std::vector<Building>& buildings);

}  // namespace strata::pipeline
