// SPDX-License-Identifier: Apache-2.0
/// Drives in buildings of which the maps have a part only: rooms, or half a floor, that nobody saw
/// before the day of the drive.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/laboratory/experiments/seed_reports.hpp"
#include "tools/laboratory/experiments/verdict_worlds.hpp"
#include "tools/shards/units.hpp"

namespace strata::experiments {

/// Sums over runs. Errors are distances of the pose from the truth at weighed scans.
struct HalfKnownOutcome {
  double runs = 0.0;
  double lost = 0.0;            ///< pipeline::LocalizationMetrics::lost
  double mapped_scans = 0.0;    ///< the map knows where the robot is
  double mapped_error_m = 0.0;  ///< sum over those
  double beyond_scans = 0.0;    ///< the others
  double beyond_error_m = 0.0;
  double called_good = 0.0;        ///< scans more than 1 m off of which the verdict is good
  double high_scored = 0.0;        ///< scans of a score of 0.9 or more
  double high_scored_wrong = 0.0;  ///< of those, more than 0.5 m off

  HalfKnownOutcome& operator+=(const HalfKnownOutcome& other);
};

/// Three days of a random office without one of its rows of rooms, or of a random floor without
/// the half at greater x: what lies there is taken out of the scans that are learned from. The
/// drive is of the fourth day, through all of the building.
[[nodiscard]] VerdictWorld half_known_office(std::uint64_t office);
[[nodiscard]] VerdictWorld half_known_floor(std::uint64_t floor);

/// One run from the truth on, with or without BeyondMapConfig::is_used.
[[nodiscard]] HalfKnownOutcome drive_half_known(const VerdictWorld& world, const std::string& model,
                                                bool goes_beyond, std::uint64_t seed);

/// Prints a line for each kind of world, model, and way; `seeds` are of the buildings.
void report_half_known(const Seeds& seeds, shards::Units& units);

/// The same on logs with poses, in maps of the first 60% of each, and on the three runs of Wean
/// Hall, each in maps of the others (where `runs` is not empty); seeds of the localizer.
void report_half_known_logs(const std::vector<std::string>& logs,
                            const std::vector<std::string>& poses,
                            const std::filesystem::path& runs, const Seeds& seeds);

}  // namespace strata::experiments
