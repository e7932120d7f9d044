// SPDX-License-Identifier: Apache-2.0
/// What is in a store, without loading it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace strata::memory {

struct StoreSummary {
  struct Grid {
    std::string name;
    double resolution_m = 0.0;
    double width_m = 0.0;
    double height_m = 0.0;
    std::int64_t bytes = 0;  ///< compressed, as are all
  };
  struct PatchMap {
    std::string name;
    std::int64_t submaps = 0;
    std::int64_t configurations = 0;
    std::int64_t sequences = 0;
    std::int64_t in_time = 0;  ///< sub-maps that follow the time of day or week
  };
  struct Run {
    std::int64_t run = 0;
    std::int64_t poses = 0;
    std::int64_t scans = 0;
    std::int64_t bytes = 0;
  };
  struct Level {
    std::string name;
    double half_life_s = 0.0;
    std::int64_t samples = 0;
    std::int64_t pairs = 0;
    std::int64_t bytes = 0;
    std::int64_t max_bytes_a_node = 0;
  };
  struct Timescale {
    std::string name;
    std::int64_t nodes = 0;
    std::int64_t observations = 0;
    std::vector<Level> levels;
  };

  std::int64_t version = 0;
  std::int64_t file_bytes = 0;  ///< the write-ahead log included
  std::vector<std::string> texts;
  std::vector<Grid> grids;
  std::vector<PatchMap> patch_maps;
  std::vector<Run> runs;
  std::vector<Timescale> timescales;
};

/// Whether a file is a store, told by its first bytes, or, of one that a program is writing, by its
/// write-ahead log. False for what cannot be read.
[[nodiscard]] bool is_store(const std::filesystem::path& path);

/// Reads a store of any version up to the present one, changing nothing. Throws InputError.
[[nodiscard]] StoreSummary summarize_store(const std::filesystem::path& path);

}  // namespace strata::memory
