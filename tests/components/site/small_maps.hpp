// SPDX-License-Identifier: Apache-2.0
/// Small MAPS folders for tests of sites.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "components/maps/maps_folder.hpp"
#include "components/site/map_version.hpp"
#include "memory/store/store.hpp"

namespace strata::test {

inline const site::Actor kAda{"ada", 1'000'000'000};

/// One that differs from others by `mark`.
inline void write_small_maps(const std::filesystem::path& folder, const std::string& mark) {
  std::filesystem::create_directories(folder / "patches");
  {
    memory::Store store(folder / maps::kStoreFile);
    ReflectionGrid grid = make_reflection_grid(0.05, {{0, 0}, {4, 3}});
    grid.at({1, 1}) = 1.0F;
    store.save_grid("filtered", grid);
    store.save_grid("occupancy", grid);
    store.save_text("mark", mark);
  }
  std::ofstream(folder / maps::kSummaryFile)
      << R"({"kind": "maps", "log": "monday.clf", "runs": 1, "scans": 12, "mark": ")" << mark
      << "\"}\n";
  std::ofstream(folder / "patches/submap0.pgm") << "P5 1 1 255\n" << mark;
}

}  // namespace strata::test
