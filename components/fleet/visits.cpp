// SPDX-License-Identifier: Apache-2.0
#include "components/fleet/visits.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <tuple>
#include <utility>

#include "components/maps/maps_folder.hpp"
#include "components/maps/thinned_runs.hpp"
#include "core/base/damage.hpp"
#include "memory/store/coded_visit.hpp"
#include "memory/store/visit_content.hpp"

namespace strata::fleet {
namespace {

std::string named(const std::string& place, const VisitName& name) {
  return place + ": visit " + std::to_string(name.number) + " of " + name.robot;
}

[[noreturn]] void throw_damaged(const std::string& place) {
  throw DamageError(place, "is damaged: its hash does not hold",
                    "set the robot aside, and look into the server's disk");
}

std::int64_t format_of(Connection& connection, const std::string& site, const VisitName& name) {
  const std::int64_t format =
      connection
          .query("SELECT format FROM strata.visit WHERE site = $1 AND robot = $2 AND visit = $3",
                 {site, name.robot, name.number})
          .integer(0, 0);
  if (format != memory::kVisitFormat && format != memory::kCodedVisitFormat) {
    throw InputError(named(connection.place(), name),
                     "is of a format that this Strata does not know", "update Strata here");
  }
  return format;
}

std::vector<PosedScan> fetch_scans(Connection& connection, const std::string& site,
                                   const VisitName& name, std::int64_t format, VersionMaps& maps) {
  const std::string place = named(connection.place(), name);
  const Rows rows = connection.query_bytes(
      "SELECT payload FROM strata.visit WHERE site = $1 AND robot = $2 AND visit = $3",
      {site, name.robot, name.number});
  const std::span<const std::byte> payload = rows.bytes(0, 0);
  if (format == memory::kVisitFormat) {
    const std::vector<std::byte> content = memory::unpack_visit(payload, place);
    if (maps::visit_hash(std::span<const std::byte>(content)) != name.sha256) throw_damaged(place);
    return memory::scans_of_visit(content, 0, place);
  }
  const ReflectionGrid& map = maps.of(memory::map_of_coded_visit(payload, place), place);
  std::vector<PosedScan> scans = memory::scans_of_coded_visit(payload, map, 0, place);
  if (scans.empty() || maps::visit_hash(scans) != name.sha256) throw_damaged(place);
  return scans;
}

Visit visit_of(std::span<const PosedScan> scans, int run) {
  Visit visit;
  visit.run = run;
  visit.name.number = scans.front().scan.stamp.ns;
  visit.end_ns = scans.back().scan.stamp.ns;
  visit.scans = scans.size();
  for (std::size_t i = 1; i < scans.size(); ++i) {
    const Pose2 step = inverse(scans[i - 1].map_from_robot) * scans[i].map_from_robot;
    visit.path_m += std::hypot(step.x, step.y);
  }
  return visit;
}

void set_content(Visit& visit, std::span<const PosedScan> scans) {
  visit.content = memory::visit_content(scans);
  visit.name.sha256 = maps::visit_hash(std::span<const std::byte>(visit.content));
}

/// A visit is never changed once it is sent, so one that nobody could read would be lost.
bool is_read_as(const memory::CodedVisit& coded, const ReflectionGrid& map,
                std::span<const std::byte> content) {
  try {
    const auto scans = memory::scans_of_coded_visit(coded.bytes, map, 0, "");
    return std::ranges::equal(memory::visit_content(scans), content);
  } catch (const DamageError&) {
    return false;
  }
}

}  // namespace

Visit visit_of(const memory::Store& store, int run, const SpacingConfig& spacing) {
  const std::vector<PosedScan> scans = spaced(store.load_scans(run), spacing);
  Visit visit = visit_of(scans, run);
  set_content(visit, scans);
  return visit;
}

std::pair<Visit, VisitPayload> told_visit(const memory::Store& store, int run,
                                          const SpacingConfig& spacing, const Coding* coding) {
  const std::vector<PosedScan> scans = spaced(store.load_scans(run), spacing);
  Visit by_itself = visit_of(scans, run);
  Visit relative = by_itself;
  set_content(by_itself, scans);
  VisitPayload payload{memory::kVisitFormat, memory::pack_visit(by_itself.content)};
  if (coding != nullptr) {
    const double tolerance_m = coding->tolerance_cells * coding->map.resolution_m();
    auto coded = memory::code_visit(scans, coding->map, coding->hash, tolerance_m);
    if (coded && coded->bytes.size() < payload.bytes.size()) {
      set_content(relative, coded->scans);
      if (is_read_as(*coded, coding->map, relative.content)) {
        return {std::move(relative), {memory::kCodedVisitFormat, std::move(coded->bytes)}};
      }
    }
  }
  return {std::move(by_itself), std::move(payload)};
}

std::vector<std::string> run_hashes(const std::filesystem::path& maps) {
  const memory::Store store = maps::open_for_reading(maps);
  std::map<int, std::string> hashes;
  for (const maps::ThinnedRun& run : maps::read_thinned_runs(store)) hashes[run.run] = run.visit;
  for (const int run : store.runs_with_scans()) {
    if (!hashes.contains(run)) hashes[run] = visit_of(store, run).name.sha256;
  }
  std::vector<std::string> all;
  for (auto& [run, hash] : hashes) all.push_back(std::move(hash));
  return all;
}

std::vector<VisitName> visit_names(Connection& connection, const std::string& site) {
  // Bytes, not letters, are compared: every server sorts alike.
  const Rows rows = connection.query(
      "SELECT v.robot, v.visit, v.sha256 FROM strata.visit AS v JOIN strata.robot AS r USING "
      "(site, robot) WHERE v.site = $1 AND r.set_aside IS NULL ORDER BY v.robot::text COLLATE "
      "\"C\", v.visit",
      {site});
  std::vector<VisitName> names;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    names.push_back({rows.text(i, 0), rows.integer(i, 1), rows.text(i, 2)});
  }
  return names;
}

std::vector<VisitName> recent_visits(Connection& connection, const std::string& site,
                                     std::size_t count) {
  const Rows rows = connection.query(
      "SELECT robot, visit, sha256 FROM (SELECT robot, visit, sha256, row_number() OVER "
      "(PARTITION BY robot ORDER BY received_at DESC, visit DESC) AS place FROM strata.visit WHERE "
      "site = $1) AS v WHERE place <= $2::bigint ORDER BY robot::text COLLATE \"C\", place",
      {site, static_cast<std::int64_t>(count)});
  std::vector<VisitName> names;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    names.push_back({rows.text(i, 0), rows.integer(i, 1), rows.text(i, 2)});
  }
  return names;
}

void for_each_visit(Connection& connection, const std::string& site,
                    const std::set<std::string>& known,
                    const std::function<void(const VisitName&, std::vector<PosedScan>)>& take,
                    const site::Site* local, const Faulty& faulty) {
  VersionMaps maps(connection, site, local);
  for (const VisitName& name : visit_names(connection, site)) {
    if (known.contains(name.sha256)) continue;
    const std::int64_t format = format_of(connection, site, name);
    std::vector<PosedScan> scans;
    try {
      scans = fetch_scans(connection, site, name, format, maps);
    } catch (const DeniedError&) {
      throw;
    } catch (const InputError& error) {
      if (!faulty) throw;
      faulty(name, error);
      continue;
    }
    take(name, std::move(scans));
  }
}

std::vector<LearnedVisit> visits_to_learn(Connection& connection, const std::string& site,
                                          const std::set<std::string>& known,
                                          const site::Site* local, const Faulty& faulty) {
  std::vector<LearnedVisit> visits;
  for_each_visit(
      connection, site, known,
      [&](const VisitName& name, std::vector<PosedScan> scans) {
        visits.push_back({name, std::move(scans)});
      },
      local, faulty);
  std::stable_sort(visits.begin(), visits.end(), [](const LearnedVisit& a, const LearnedVisit& b) {
    return std::tie(a.name.number, a.name.robot) < std::tie(b.name.number, b.name.robot);
  });
  return visits;
}

}  // namespace strata::fleet
