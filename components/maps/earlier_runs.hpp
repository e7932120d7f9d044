// SPDX-License-Identifier: Apache-2.0
/// What a MAPS folder keeps so that learning can go on from it (`learn --update`).
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "components/maps/thinned_runs.hpp"
#include "core/geometry/pose2.hpp"
#include "core/scan/history.hpp"
#include "core/scan/scan.hpp"
#include "memory/nodes/timescale_memory.hpp"

namespace strata::maps {

struct EarlierRuns {
  std::string log;                                     ///< names of the logs, as in summary.json
  std::vector<PosedScan> scans;                        ///< of all runs, in order, in the map frame
  std::shared_ptr<memory::TimescaleMemory> timescale;  ///< null when none was learned
  std::optional<Pose2> map_from_truth;
  int next_run = 0;                 ///< the run id that no scan has yet
  std::vector<ThinnedRun> thinned;  ///< runs that lack scans, by their ids; or have none any more
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

/// Forgets scans of runs before `next_run` (scans_to_keep), and notes of which runs. Returns
/// how many. O(n log n + beams of the runs that lose some).
std::size_t forget_scans(EarlierRuns& earlier, const HistoryConfig& config);

/// The runs of `other`, in their order, that `earlier` does not hold. Stamps may begin anew
/// in each log, and scans may have been blinded or left out since: a run is known where two of its
/// scans, or its only one, have stamp and pose of a scan there to every bit, which updates keep;
/// and where `earlier` has forgotten scans of it. O(n log n).
[[nodiscard]] std::vector<std::vector<PosedScan>> new_runs(EarlierRuns other,
                                                           const EarlierRuns& earlier);

}  // namespace strata::maps
