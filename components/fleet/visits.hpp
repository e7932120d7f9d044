// SPDX-License-Identifier: Apache-2.0
/// Visits: what one robot saw on one drive, as a fleet's server keeps it (docs/fleet.md, "What a
/// visit is").
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "components/fleet/connection.hpp"
#include "components/fleet/version_maps.hpp"
#include "core/scan/scan.hpp"
#include "core/scan/spacing.hpp"
#include "memory/store/store.hpp"

namespace strata::fleet {

/// What names a visit: of a robot no two have the same number.
struct VisitName {
  std::string robot;
  std::int64_t number = 0;  ///< stamp of its first scan, in nanoseconds
  std::string sha256;       ///< of its content as it is read (memory/store/visit_content.hpp)
};

struct Visit {
  VisitName name;
  int run = 0;  ///< of a MAPS folder
  std::int64_t end_ns = 0;
  std::size_t scans = 0;
  double path_m = 0.0;
  std::vector<std::byte> content;
};

/// As it goes over the wire.
struct VisitPayload {
  int format = 0;
  std::vector<std::byte> bytes;
};

/// A run of a MAPS folder as a visit, without a robot; of its scans those that are spaced so.
/// Requires scans. O(beams).
[[nodiscard]] Visit visit_of(const memory::Store& store, int run,
                             const SpacingConfig& spacing = {});

/// The same with how it is sent: relative to `coding` where that is given and takes it in fewer
/// bytes, else by itself. Its content and hash are those of what is read of it; number, end and
/// path stay as they were measured. O(beams).
[[nodiscard]] std::pair<Visit, VisitPayload> told_visit(const memory::Store& store, int run,
                                                        const SpacingConfig& spacing,
                                                        const Coding* coding);

/// The hash of each run's visit of a MAPS folder, in the order of the runs; of runs that lack
/// scans, or have none any more, as it was when they had all. O(beams of all).
[[nodiscard]] std::vector<std::string> run_hashes(const std::filesystem::path& maps);

/// Who is told of a visit that cannot be read.
using Faulty = std::function<void(const VisitName&, const InputError&)>;

/// Every visit of a site but those of robots that were set aside and those whose hash is in
/// `known`, sorted by robot and number, so that who came first makes no difference; payloads are
/// fetched one by one, unpacked, and their hash is checked. local: a site that may have the
/// versions that visits are relative to, or null. faulty: is told of those whose hash does not
/// hold, or whose version nobody has; without it they are thrown, as DamageError or InputError. For
/// an operator or the owner. Throws InputError for a format of a newer Strata.
void for_each_visit(Connection& connection, const std::string& site,
                    const std::set<std::string>& known,
                    const std::function<void(const VisitName&, std::vector<PosedScan>)>& take,
                    const site::Site* local = nullptr, const Faulty& faulty = {});

struct LearnedVisit {
  VisitName name;
  std::vector<PosedScan> scans;
};

/// What `strata fleet learn` learns, in the order in which it does: those whose hash is not in
/// `known`, by their begin, and of one begin by the robots' names. The same bits whoever pushed
/// first, and in whatever groups. As for_each_visit() otherwise.
[[nodiscard]] std::vector<LearnedVisit> visits_to_learn(Connection& connection,
                                                        const std::string& site,
                                                        const std::set<std::string>& known,
                                                        const site::Site* local = nullptr,
                                                        const Faulty& faulty = {});

/// Of each robot of a site the last `count` visits that the server received, the newest first.
[[nodiscard]] std::vector<VisitName> recent_visits(Connection& connection, const std::string& site,
                                                   std::size_t count);

/// The names alone.
[[nodiscard]] std::vector<VisitName> visit_names(Connection& connection, const std::string& site);

}  // namespace strata::fleet
