// SPDX-License-Identifier: Apache-2.0
/// Robots that are carried away while they are tracked: how soon they find themselves, and what
/// looking for it costs those that are not.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tools/laboratory/experiments/seed_reports.hpp"
#include "tools/laboratory/experiments/verdict_worlds.hpp"
#include "tools/shards/units.hpp"

namespace strata::experiments {

/// Sums. Scans are weighed ones; found: within 0.5 m of the truth for ten scans on end.
struct KidnappedOutcome {
  double times = 0.0;
  double found = 0.0;          ///< before the drive ended
  double found_soon = 0.0;     ///< ... within 10 s
  double found_after_s = 0.0;  ///< sum over those found
  double sure = 0.0;           ///< in the end right and not ambiguous, verdict good
  double sure_wrong = 0.0;   ///< sure of a place more than 1 m off for ten scans on end, after 10 s
  double drives = 0.0;       ///< the whole drive, from the truth on, nobody carried away
  double lost_drives = 0.0;  ///< pipeline::LocalizationMetrics::lost
  double scans = 0.0;
  double error_m = 0.0;  ///< sum
  double off = 0.0;      ///< more than 0.5 m
  double ambiguous = 0.0;

  KidnappedOutcome& operator+=(const KidnappedOutcome& other);
};

/// One drive from the truth on, and `times` that each track 150 scans and then see, without
/// odometry telling, 300 scans of elsewhere in the drive, at least 2 m away.
[[nodiscard]] KidnappedOutcome carry_away(const VerdictWorld& world, const std::string& model,
                                          bool watches, int times, std::uint64_t seed);

/// Prints a line for each kind of world, model, and way.
void report_kidnapped(const std::string& scenarios, const Seeds& seeds, shards::Units& units);

/// The same on logs with poses, maps of the first 60% of each; seeds of the localizer.
void report_kidnapped_logs(const std::vector<std::string>& logs,
                           const std::vector<std::string>& poses, const Seeds& seeds);

}  // namespace strata::experiments
