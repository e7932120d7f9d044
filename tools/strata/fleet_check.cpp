// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/fleet_check.hpp"

#include <algorithm>
#include <cstddef>
#include <map>
#include <utility>

#include "components/fleet/clock.hpp"
#include "components/fleet/status.hpp"
#include "components/maps/maps_folder.hpp"
#include "core/base/error.hpp"
#include "tools/report/plot.hpp"
#include "tools/strata/warning.hpp"
#include "tools/strata/words.hpp"

namespace strata::tools {
namespace {

using nlohmann::json;
using Visits = std::vector<fleet::LearnedVisit>;
/// Why each is left out, by its name.
using Reasons = std::map<std::string, std::string>;

/// One lost drive is none of many, and a robot that broke is found within a week or so.
constexpr std::size_t kRecent = 10;

void take_away(Visits& visits, const Reasons& reasons) {
  std::erase_if(visits, [&](const fleet::LearnedVisit& visit) {
    return reasons.contains(name_of(visit.name));
  });
}

std::set<std::string> robots_of(const Visits& visits) {
  std::set<std::string> robots;
  for (const fleet::LearnedVisit& visit : visits) robots.insert(visit.name.robot);
  return robots;
}

/// Visits that end in the server's future; what was found of their robots.
json check_clocks(fleet::Connection& connection, const std::string& site,
                  const std::set<std::string>& known, const Visits& visits, Reasons& reasons) {
  std::map<std::string, double> ahead_s;
  for (const fleet::AheadVisit& visit : fleet::visits_ahead(connection, site, known)) {
    ahead_s[visit.name.robot] = std::max(ahead_s[visit.name.robot], visit.ahead_s);
    reasons[name_of(visit.name)] = "a visit ends " + report::fixed(visit.ahead_s, 0) +
                                   " s after the server received it: its clock was ahead";
  }
  const std::size_t robots = robots_of(visits).size();
  if (robots > 1 && 2 * ahead_s.size() > robots) {
    throw InputError(connection.place(),
                     "received visits of " + std::to_string(ahead_s.size()) + " of " +
                         counted(robots, "robot") +
                         " before they ended: its own clock was behind, not theirs",
                     "set its clock by NTP, then learn these visits by --unchecked");
  }
  json checked = json::array();
  for (const auto& [robot, seconds] : ahead_s) {
    checked.push_back({{"robot", robot}, {"clock_ahead_s", seconds}, {"set_aside", nullptr}});
  }
  return checked;
}

/// Visits that contradict the map as no other robot's do; what was found of all robots.
json check_scans(const std::filesystem::path& base, const site::RobotLimits& limits,
                 const Visits& visits, Reasons& reasons) {
  std::map<std::string, site::RobotVisits> by_name;
  std::map<std::string, std::vector<std::string>> names;
  for (const fleet::LearnedVisit& visit : visits) {
    by_name[visit.name.robot].robot = visit.name.robot;
    by_name[visit.name.robot].visits.emplace_back(visit.scans);
    names[visit.name.robot].push_back(name_of(visit.name));
  }
  std::vector<site::RobotVisits> robots;
  for (auto& [name, robot] : by_name) robots.push_back(std::move(robot));
  const ReflectionGrid map = maps::open_for_reading(base).load_reflection_grid("filtered");
  json checked = json::array();
  for (const site::RobotJudgement& robot : site::judge_robots(map, robots, limits)) {
    checked.push_back({{"robot", robot.robot},
                       {"scans", robot.scans},
                       {"contradicted", robot.contradicted},
                       {"others", robot.others ? json(*robot.others) : json(nullptr)},
                       {"set_aside", nullptr}});
    for (std::size_t i = 0; i < robot.visits.size(); ++i) {
      if (!robot.visits[i].why.empty()) reasons[names[robot.robot][i]] = robot.visits[i].why;
    }
  }
  return checked;
}

/// Robots most of whose last visits are left out, with the reason.
std::map<std::string, std::string> wrong_robots(fleet::Connection& connection,
                                                const std::string& site, const Reasons& reasons) {
  std::map<std::string, std::size_t> all;
  std::map<std::string, std::size_t> wrong;
  std::map<std::string, std::string> why;
  for (const fleet::VisitName& visit : fleet::recent_visits(connection, site, kRecent)) {
    ++all[visit.robot];
    const auto reason = reasons.find(name_of(visit));
    if (reason == reasons.end()) continue;
    ++wrong[visit.robot];
    why.try_emplace(visit.robot, reason->second);
  }
  std::erase_if(why, [&](const auto& robot) { return 2 * wrong[robot.first] <= all[robot.first]; });
  for (auto& [robot, text] : why) {
    text +=
        " (" + std::to_string(wrong[robot]) + " of its last " + counted(all[robot], "visit") + ")";
  }
  return why;
}

}  // namespace

std::string name_of(const fleet::VisitName& visit) {
  return visit.robot + ":" + std::to_string(visit.number);
}

std::set<std::string> hashes_of(fleet::Connection& connection, const std::string& site,
                                const std::vector<std::string>& names) {
  std::map<std::string, std::string> there;
  if (!names.empty()) {
    for (const fleet::VisitName& visit : fleet::visit_names(connection, site)) {
      there[name_of(visit)] = visit.sha256;
    }
  }
  std::set<std::string> hashes;
  for (const std::string& name : names) {
    if (!there.contains(name)) {
      throw InputError("--without " + name, "is no visit that would be learned",
                       "name it as the warning did: ROBOT:NUMBER");
    }
    hashes.insert(there[name]);
  }
  return hashes;
}

FleetCheck check_visits(fleet::Connection& connection, const std::string& site,
                        const std::filesystem::path& base, const std::set<std::string>& known,
                        const site::RobotLimits& limits, Visits& visits, VerbContext& context) {
  FleetCheck check;
  Reasons reasons;
  check.checked = check_clocks(connection, site, known, visits, reasons);
  take_away(visits, reasons);
  for (json& robot : check_scans(base, limits, visits, reasons)) check.checked.push_back(robot);
  take_away(visits, reasons);
  const auto wrong = wrong_robots(connection, site, reasons);
  for (const auto& [robot, why] : wrong) {
    fleet::set_aside(connection, site, robot, "by learn: " + why);
    warn(context, robot + " is set aside: " + why + "; look at it, then `strata fleet set-aside " +
                      robot + " --undo` and learn with --unchecked, if it is right");
    std::erase_if(visits, [&](const auto& visit) { return visit.name.robot == robot; });
    for (json& found : check.checked) {
      if (found["robot"] == robot) found["set_aside"] = why;
    }
  }
  for (const auto& [name, why] : reasons) {
    check.left_out.push_back({{"visit", name}, {"why", why}});
    if (wrong.contains(name.substr(0, name.find(':')))) continue;
    warn(context, "visit " + name + " is left out: " + why);
  }
  return check;
}

}  // namespace strata::tools
