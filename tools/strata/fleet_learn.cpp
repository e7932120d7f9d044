// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/fleet_learn.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "components/fleet/clock.hpp"
#include "components/fleet/status.hpp"
#include "components/fleet/versions.hpp"
#include "components/fleet/visits.hpp"
#include "components/maps/earlier_runs.hpp"
#include "components/maps/learn_config.hpp"
#include "components/maps/maps_folder.hpp"
#include "core/base/error.hpp"
#include "tools/pipeline/cost.hpp"
#include "tools/pipeline/learn.hpp"
#include "tools/report/plot.hpp"
#include "tools/strata/learned_folder.hpp"
#include "tools/strata/result_directory.hpp"
#include "tools/strata/verb_config.hpp"

namespace strata::tools {
namespace {

/// Keeps a robot's visits, of which nothing is learned any more.
void set_aside(fleet::Connection& connection, const std::string& site, const std::string& robot,
               const std::string& why, std::vector<fleet::LearnedVisit>& visits,
               VerbContext& context) {
  fleet::set_aside(connection, site, robot, "by learn: " + why);
  context.note("warning: " + robot + " is set aside: " + why +
               "; look at it, then `strata fleet set-aside " + robot +
               " --undo` and learn with --unchecked, if it is right");
  std::erase_if(visits,
                [&](const fleet::LearnedVisit& visit) { return visit.name.robot == robot; });
}

/// Robots whose visits end in the server's future are set aside; what was found, for the summary.
nlohmann::json check_clocks(fleet::Connection& connection, const std::string& site,
                            const std::set<std::string>& known,
                            std::vector<fleet::LearnedVisit>& visits, VerbContext& context) {
  std::map<std::string, double> ahead_s;
  for (const fleet::AheadVisit& visit : fleet::visits_ahead(connection, site, known)) {
    ahead_s[visit.name.robot] = std::max(ahead_s[visit.name.robot], visit.ahead_s);
  }
  nlohmann::json checked = nlohmann::json::array();
  for (const auto& [robot, seconds] : ahead_s) {
    const std::string why = "a visit ends " + report::fixed(seconds, 0) +
                            " s after the server received it: its clock was ahead";
    checked.push_back({{"robot", robot}, {"clock_ahead_s", seconds}, {"set_aside", why}});
    set_aside(connection, site, robot, why, visits, context);
  }
  return checked;
}

/// Judges each robot by the scans that are to be learned; those who contradict the map as no other
/// does are set aside on the server, and their visits go. What was found, for the summary.
nlohmann::json check_robots(fleet::Connection& connection, const std::string& site,
                            const std::filesystem::path& base, const site::RobotLimits& limits,
                            std::vector<fleet::LearnedVisit>& visits, VerbContext& context) {
  std::map<std::string, site::RobotVisits> by_name;
  for (const fleet::LearnedVisit& visit : visits) {
    by_name[visit.name.robot].robot = visit.name.robot;
    by_name[visit.name.robot].visits.emplace_back(visit.scans);
  }
  std::vector<site::RobotVisits> robots;
  for (auto& [name, robot] : by_name) robots.push_back(std::move(robot));
  const ReflectionGrid map = maps::open_for_reading(base).load_reflection_grid("filtered");
  nlohmann::json checked = nlohmann::json::array();
  for (const site::RobotJudgement& robot : site::judge_robots(map, robots, limits)) {
    checked.push_back(
        {{"robot", robot.robot},
         {"scans", robot.scans},
         {"contradicted", robot.contradicted},
         {"others", robot.others ? nlohmann::json(*robot.others) : nlohmann::json(nullptr)},
         {"set_aside", robot.why.empty() ? nlohmann::json(nullptr) : nlohmann::json(robot.why)}});
    if (robot.why.empty()) continue;
    set_aside(connection, site, robot.robot, robot.why, visits, context);
  }
  return checked;
}

}  // namespace

nlohmann::json learn_fleet(fleet::Connection& connection, const site::Site& site,
                           const std::string& out_folder,
                           const std::optional<site::RobotLimits>& limits, VerbContext& context) {
  const pipeline::CostMeter meter;
  const auto config = read_config<maps::LearnConfig>(context);
  ResultDirectory out(out_folder, "maps", context);
  fleet::require_same_site(connection, site);
  const std::filesystem::path base = site.maps_of(site.find("active").version.hash);
  maps::EarlierRuns earlier = maps::read_earlier_runs(base);
  const std::vector<std::string> known = fleet::run_hashes(base);
  std::vector<fleet::LearnedVisit> visits = fleet::visits_to_learn(
      connection, site.decisions().id, std::set<std::string>(known.begin(), known.end()), &site);
  if (visits.empty()) {
    throw InputError(connection.place(), "has no visit that the active version does not hold",
                     "push some, or wait for robots that do");
  }
  nlohmann::json checked = nlohmann::json::array();
  if (limits) {
    const std::string id = site.decisions().id;
    checked = check_clocks(connection, id, {known.begin(), known.end()}, visits, context);
    for (nlohmann::json& robot : check_robots(connection, id, base, *limits, visits, context)) {
      checked.push_back(std::move(robot));
    }
  }
  std::set<std::string> robots;
  for (const fleet::LearnedVisit& visit : visits) robots.insert(visit.name.robot);
  const std::size_t count = visits.size();
  for (fleet::LearnedVisit& visit : visits) maps::add_run(earlier, std::move(visit.scans));
  const pipeline::LearnResult result =
      pipeline::learn({}, {}, config, {}, context.options.seed, context.options.threads,
                      context.progress(), &earlier);
  for (const std::string& warning : result.slam.warnings) context.note("warning: " + warning);
  std::string logs = earlier.log;
  for (const std::string& robot : robots) logs += (logs.empty() ? "" : " ") + robot;
  nlohmann::json summary = write_learned(
      out, result, {}, {logs, earlier.map_from_truth, &meter, earlier.thinned}, context);
  summary["visits"] = count;
  summary["robots"] = robots;
  summary["checked"] = checked;
  return summary;
}

std::string set_aside_in(const nlohmann::json& summary) {
  std::string text;
  for (const nlohmann::json& robot : summary["checked"]) {
    if (robot["set_aside"].is_null()) continue;
    text += "; set aside " + robot["robot"].get<std::string>() + ": " +
            robot["set_aside"].get<std::string>();
  }
  return text;
}

}  // namespace strata::tools
