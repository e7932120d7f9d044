// SPDX-License-Identifier: Apache-2.0
/// Levels of a building (docs/site.md, "Floors"): each is a site of its own, in the building's
/// frame.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace strata::site {

inline constexpr const char* kLevelsFolder = "levels";
inline constexpr const char* kLevelFile = "level.json";

struct Level {
  std::string name;              ///< its folder's
  double elevation_m = 0.0;      ///< of its floor
  std::filesystem::path folder;  ///< of its site
};

/// Of the folder of a site, from the lowest up; empty where it is no building. Throws InputError
/// for a damaged level.
[[nodiscard]] std::vector<Level> levels_of(const std::filesystem::path& site);

}  // namespace strata::site
