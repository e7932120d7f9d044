// SPDX-License-Identifier: Apache-2.0
#include "components/fleet/push.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "components/fleet/schema.hpp"
#include "components/fleet/versions.hpp"
#include "components/maps/maps_folder.hpp"
#include "components/maps/thinned_runs.hpp"
#include "memory/store/coded_visit.hpp"

namespace strata::fleet {
namespace {

struct OwnVisit {
  std::string sha256;
  std::size_t scans = 0;
  std::int64_t end_ns = 0;
  double path_m = 0.0;
};

/// What the server has of this robot, by number. Tables from before do not tell a robot how many
/// scans a visit has and when it ended: who sends every scan by itself can do without (0).
std::map<std::int64_t, OwnVisit> own_visits(Connection& connection, const Member& robot,
                                            bool sends_all) {
  const std::string what = "SELECT visit, sha256, scans, end_ns, path_m FROM strata.visit ";
  const std::string less = "SELECT visit, sha256, 0, 0, 0 FROM strata.visit ";
  const std::string whose = "WHERE site = $1 AND robot = $2";
  const auto ask = [&] {
    try {
      return connection.query(what + whose, {robot.site, robot.name});
    } catch (const DeniedError&) {
      if (sends_all) return connection.query(less + whose, {robot.site, robot.name});
      throw DeniedError(connection.place(),
                        "does not let robots compare spaced or coded visits yet",
                        "its owner does by `strata fleet init` once more; until then send every "
                        "scan (spacing 0) by itself (tolerance 0, no --against)");
    }
  };
  const Rows rows = ask();
  std::map<std::int64_t, OwnVisit> visits;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    visits[rows.integer(i, 0)] = {rows.text(i, 1), static_cast<std::size_t>(rows.integer(i, 2)),
                                  rows.integer(i, 3), rows.real(i, 4)};
  }
  return visits;
}

/// A run that lies here, without its content.
struct LocalVisit {
  Visit visit;
  std::string whole;  ///< its hash when it had all of its scans
};

/// A run that lacks scans keeps the number that it had.
std::vector<LocalVisit> local_visits(const memory::Store& store, const Member& robot) {
  const std::vector<maps::ThinnedRun> thinned = maps::read_thinned_runs(store);
  std::vector<LocalVisit> visits;
  for (const int run : store.runs_with_scans()) {
    Visit visit = visit_of(store, run);
    visit.content = {};  // of long memories only the one that is sent is held
    visit.name.robot = robot.name;
    std::string whole = visit.name.sha256;
    if (const maps::ThinnedRun* before = maps::thinned_run(thinned, run)) {
      visit.name.number = before->begin_ns;
      whole = before->visit;
    }
    visits.push_back({std::move(visit), std::move(whole)});
  }
  return visits;
}

/// Which of these are in a version of the site.
std::set<std::string> released_runs(Connection& connection, const std::vector<LocalVisit>& visits) {
  std::vector<std::string> hashes;
  for (const LocalVisit& visit : visits) hashes.push_back(visit.whole);
  const auto ask = [&] {
    try {
      return connection.query("SELECT strata.known_runs($1::text[])", {array_of(hashes)});
    } catch (const DeniedError&) {  // tables from before tell all only
      return connection.query("SELECT strata.known_runs()");
    }
  };
  const Rows rows = ask();
  std::set<std::string> runs;
  for (std::size_t i = 0; i < rows.size(); ++i) runs.insert(rows.text(i, 0));
  return runs;
}

/// Whether the server has that drive, or as much of it as was sent.
bool is_same(const OwnVisit& there, const LocalVisit& here) {
  if (there.sha256 == here.whole) return true;
  // What is left of a visit has no hash to compare: it is there by its number.
  if (here.visit.name.sha256 != here.whole) return true;
  if (there.end_ns != here.visit.end_ns) return false;
  // Spaced, or told relative to a version: its path is the one that was measured, but for what
  // another processor or library of mathematics makes of the same poses.
  constexpr double kRounding = 1e-6;
  const double off_m = std::abs(there.path_m - here.visit.path_m);
  return there.scans < here.visit.scans ||
         (there.scans == here.visit.scans && off_m <= kRounding * (1.0 + here.visit.path_m));
}

void require_same_frame(Connection& connection, const std::filesystem::path& maps,
                        const std::vector<LocalVisit>& visits,
                        const std::set<std::string>& released) {
  const bool shares_one = std::any_of(visits.begin(), visits.end(), [&](const LocalVisit& visit) {
    return released.contains(visit.whole);
  });
  if (shares_one) return;
  if (connection.query("SELECT strata.known_runs() LIMIT 1").size() == 0) {
    throw InputError(connection.place(),
                     "has no version of the site yet, so nobody knows its frame",
                     "an operator releases one first: `strata fleet release`");
  }
  throw InputError(maps.string(),
                   "was not learned from a version of the site: its frame is its own",
                   "pull a version, and learn with `--update` of its maps");
}

/// One statement, which is one transaction.
PushOutcome send(Connection& connection, const Member& robot, const Visit& visit,
                 const VisitPayload& payload, const LocalVisit& local) {
  const Rows sent = connection.query(
      "INSERT INTO strata.visit (site, robot, visit, sha256, format, scans, end_ns, path_m, "
      "payload) VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9) ON CONFLICT DO NOTHING",
      {robot.site, robot.name, visit.name.number, visit.name.sha256, payload.format, visit.scans,
       visit.end_ns, visit.path_m, std::span<const std::byte>(payload.bytes)});
  if (sent.changed() == 1) return PushOutcome::kSent;
  const auto there = own_visits(connection, robot, true);  // another process was quicker
  return is_same(there.at(visit.name.number), local) ? PushOutcome::kThere : PushOutcome::kClash;
}

/// Others can read what is told relative to a version only where they can have that.
bool is_released(Connection& connection, const std::string& site, const std::string& hash) {
  const std::optional<ServerVersion> version = version_of(connection, site, hash);
  return version && version->state == "released";
}

}  // namespace

const char* name_of(PushOutcome outcome) {
  switch (outcome) {
    case PushOutcome::kSent:
      return "sent";
    case PushOutcome::kThere:
      return "there";
    case PushOutcome::kReleased:
      return "released";
    case PushOutcome::kClash:
      break;
  }
  return "clash";
}

void push(Connection& connection, const std::string& site, const std::filesystem::path& maps,
          const std::function<void(const PushedVisit&)>& told, const SpacingConfig& spacing,
          const Coding* coding) {
  const Member robot = require_member(connection, site);
  if (robot.kind != MemberKind::kRobot) {
    throw InputError(connection.place(),
                     robot.role + " is an " + name_of(robot.kind) + ", and visits are robots'",
                     "give the URL that `strata fleet add-robot` printed");
  }
  const memory::Store store = maps::open_for_reading(maps);
  const std::vector<LocalVisit> visits = local_visits(store, robot);
  const std::set<std::string> released = released_runs(connection, visits);
  require_same_frame(connection, maps, visits, released);
  if (coding != nullptr && !is_released(connection, site, coding->hash)) coding = nullptr;
  const auto there = own_visits(connection, robot, spacing.spacing_m <= 0.0 && coding == nullptr);
  for (const LocalVisit& local : visits) {
    const auto& [visit, whole] = local;
    PushedVisit pushed{visit.name,   whole, visit.run, visit.scans,
                       visit.path_m, 0,     {},        PushOutcome::kReleased};
    const auto same_number = there.find(visit.name.number);
    if (!released.contains(whole)) {
      if (same_number != there.end()) {
        pushed.outcome =
            is_same(same_number->second, local) ? PushOutcome::kThere : PushOutcome::kClash;
      } else {
        auto [sent, payload] = told_visit(store, visit.run, spacing, coding);
        sent.name.robot = robot.name;
        sent.name.number = visit.name.number;
        pushed.outcome = send(connection, robot, sent, payload, local);
        pushed.name = sent.name;
        pushed.scans = sent.scans;
        if (pushed.outcome == PushOutcome::kSent) {
          pushed.bytes = payload.bytes.size();
          if (payload.format == memory::kCodedVisitFormat) pushed.relative_to = coding->hash;
        }
      }
    }
    told(pushed);
  }
}

InputError clash_error(const Connection& connection, const VisitName& visit) {
  return {connection.place(),
          "has another visit of this robot that began at the same nanosecond, " +
              std::to_string(visit.number) + ", which stays",
          "look whether a clock was set back, or two robots share a name; the other visits were "
          "sent"};
}

}  // namespace strata::fleet
