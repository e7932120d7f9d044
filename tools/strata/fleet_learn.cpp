// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/fleet_learn.hpp"

#include <set>
#include <utility>
#include <vector>

#include "components/fleet/versions.hpp"
#include "components/fleet/visits.hpp"
#include "components/maps/earlier_runs.hpp"
#include "components/maps/learn_config.hpp"
#include "components/maps/maps_folder.hpp"
#include "core/base/error.hpp"
#include "tools/pipeline/cost.hpp"
#include "tools/pipeline/learn.hpp"
#include "tools/strata/fleet_check.hpp"
#include "tools/strata/learned_folder.hpp"
#include "tools/strata/result_directory.hpp"
#include "tools/strata/verb_config.hpp"
#include "tools/strata/warning.hpp"
#include "tools/strata/words.hpp"

namespace strata::tools {
namespace {

/// Those that can be read; the others are warned of, and told in `left_out`.
std::vector<fleet::LearnedVisit> readable_visits(fleet::Connection& connection,
                                                 const site::Site& site,
                                                 const std::set<std::string>& known,
                                                 nlohmann::json& left_out, VerbContext& context) {
  const auto faulty = [&](const fleet::VisitName& visit, const InputError& error) {
    left_out.push_back({{"visit", name_of(visit)}, {"why", error.problem()}});
    warn(context,
         "visit " + name_of(visit) + " is left out: it " + error.problem() + "; " + error.remedy());
  };
  return fleet::visits_to_learn(connection, site.decisions().id, known, &site, faulty);
}

}  // namespace

nlohmann::json learn_fleet(fleet::Connection& connection, const site::Site& site,
                           const FleetLearnTask& task, VerbContext& context) {
  const pipeline::CostMeter meter;
  const auto config = read_config<maps::LearnConfig>(context);
  ResultDirectory out(task.out, "maps", context);
  fleet::require_same_site(connection, site);
  const std::filesystem::path base = site.maps_of(site.find("active").version.hash);
  maps::EarlierRuns earlier = maps::read_earlier_runs(base);
  const std::string id = site.decisions().id;
  std::set<std::string> known = hashes_of(connection, id, task.without);
  for (std::string& hash : fleet::run_hashes(base)) known.insert(std::move(hash));
  nlohmann::json left_out = nlohmann::json::array();
  std::vector<fleet::LearnedVisit> visits =
      readable_visits(connection, site, known, left_out, context);
  if (visits.empty() && left_out.empty()) {
    throw InputError(connection.place(), "has no visit that the active version does not hold",
                     "push some, or wait for robots that do");
  }
  nlohmann::json checked = nlohmann::json::array();
  if (task.limits && !visits.empty()) {
    FleetCheck check = check_visits(connection, id, base, known, *task.limits, visits, context);
    checked = std::move(check.checked);
    for (nlohmann::json& visit : check.left_out) left_out.push_back(std::move(visit));
  }
  if (visits.empty()) {
    throw InputError(connection.place(), "has no visit left to learn from",
                     "the warnings say why; --unchecked takes those that can be read");
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
  summary["left_out"] = left_out;
  return summary;
}

std::string set_aside_in(const nlohmann::json& summary) {
  std::string text;
  const std::size_t left_out = summary["left_out"].size();
  if (left_out > 0) text += "; left out " + counted(left_out, "visit");
  std::set<std::string> told;
  for (const nlohmann::json& robot : summary["checked"]) {
    if (robot["set_aside"].is_null() || !told.insert(robot["robot"]).second) continue;
    text += "; set aside " + robot["robot"].get<std::string>() + ": " +
            robot["set_aside"].get<std::string>();
  }
  return text;
}

}  // namespace strata::tools
