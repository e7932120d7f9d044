// SPDX-License-Identifier: Apache-2.0
/// What a MAPS folder keeps so that learning can go on from it (`learn --update`).
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/pose2.hpp"
#include "core/scan/scan.hpp"
#include "memory/nodes/timescale_memory.hpp"

namespace strata::maps {

struct EarlierRuns {
  std::string log;                                     ///< names of the logs, as in summary.json
  std::vector<PosedScan> scans;                        ///< of all runs, in order, in the map frame
  std::shared_ptr<memory::TimescaleMemory> timescale;  ///< null when none was learned
  std::optional<Pose2> map_from_truth;
  int next_run = 0;  ///< the run id that no scan has yet
};

/// The names of the logs that the maps in a folder were learned from, by its summary; empty when
/// that is missing or cannot be read.
[[nodiscard]] std::string log_of(const std::filesystem::path& dir);

/// Reads them. Throws InputError when the folder has no strata.db, is damaged, or was written by a
/// version that kept no scans. O(beams of all runs).
[[nodiscard]] EarlierRuns read_earlier_runs(const std::filesystem::path& dir);

/// Adds a run that was placed already, in the map frame, behind all others. `next_run` stays, so
/// that all that counts runs from there takes it for new.
void add_run(EarlierRuns& earlier, std::vector<PosedScan> scans);

/// The runs among these scans, in their order, that `earlier` does not hold. Stamps may begin anew
/// in each log, and scans may have been blinded or left out since: a run is known where two of its
/// scans, or its only one, have stamp and pose of a scan there to every bit, which updates keep.
/// O(n log n).
[[nodiscard]] std::vector<std::vector<PosedScan>> new_runs(std::vector<PosedScan> scans,
                                                           const EarlierRuns& earlier);

}  // namespace strata::maps
