// SPDX-License-Identifier: Apache-2.0
/// Runs of a MAPS folder whose scans were forgotten in part or as a whole (core/scan/history.hpp):
/// who comes with one of them again is told that it is known.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/scan/scan.hpp"
#include "memory/store/store.hpp"

namespace strata::maps {

/// As it was before it lost its first scan.
struct ThinnedRun {
  int run = 0;
  std::string visit;  ///< SHA-256 of its content as a visit (memory/store/visit_content.hpp)
  std::int64_t begin_ns = 0;  ///< stamp of its first scan
};

/// The one with that id, or null.
[[nodiscard]] const ThinnedRun* thinned_run(std::span<const ThinnedRun> thinned, int run);

/// SHA-256 of a run's content as a visit. Requires scans. O(beams).
[[nodiscard]] std::string visit_hash(std::span<const PosedScan> scans);
/// The same of a content that is made already. O(bytes).
[[nodiscard]] std::string visit_hash(std::span<const std::byte> content);

/// Adds them to a folder that write_grid_maps wrote to. Throws OutputError.
void write_thinned_runs(const std::filesystem::path& dir, std::span<const ThinnedRun> thinned);

/// What write_thinned_runs left; none where nothing was forgotten. Throws DamageError.
[[nodiscard]] std::vector<ThinnedRun> read_thinned_runs(const memory::Store& store);

}  // namespace strata::maps
