// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/fleet_learn.hpp"

#include <iterator>
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
#include "tools/pipeline/learn_pictures.hpp"
#include "tools/report/drawings.hpp"
#include "tools/strata/result_directory.hpp"
#include "tools/strata/verb_config.hpp"
#include "tools/strata/warning.hpp"

namespace strata::tools {
namespace {

/// As runs that were placed already; `next_run` stays, so that the timescale memory, which goes on
/// from where it was, takes them for new.
void append(std::vector<fleet::LearnedVisit> visits, maps::EarlierRuns& earlier) {
  int run = earlier.next_run;
  for (fleet::LearnedVisit& visit : visits) {
    for (PosedScan& scan : visit.scans) scan.run = run;
    earlier.scans.insert(earlier.scans.end(), std::make_move_iterator(visit.scans.begin()),
                         std::make_move_iterator(visit.scans.end()));
    ++run;
  }
}

}  // namespace

nlohmann::json learn_fleet(fleet::Connection& connection, const site::Site& site,
                           const std::string& out_folder, VerbContext& context) {
  const pipeline::CostMeter meter;
  const auto config = read_config<maps::LearnConfig>(context);
  ResultDirectory out(out_folder, "maps", context);
  fleet::require_same_site(connection, site);
  const std::filesystem::path base = site.maps_of(site.find("active").version.hash);
  maps::EarlierRuns earlier = maps::read_earlier_runs(base);
  const std::vector<std::string> known = fleet::run_hashes(base);
  std::vector<fleet::LearnedVisit> visits = fleet::visits_to_learn(
      connection, site.decisions().id, std::set<std::string>(known.begin(), known.end()));
  if (visits.empty()) {
    throw InputError(connection.place(), "has no visit that the active version does not hold",
                     "push some, or wait for robots that do");
  }
  std::set<std::string> robots;
  for (const fleet::LearnedVisit& visit : visits) robots.insert(visit.name.robot);
  const std::size_t count = visits.size();
  append(std::move(visits), earlier);
  const pipeline::LearnResult result =
      pipeline::learn({}, {}, config, {}, context.options.seed, context.options.threads,
                      context.progress(), &earlier);
  for (const std::string& warning : result.slam.warnings) context.note("warning: " + warning);
  maps::write_grid_maps(out.path(), result.slam);
  maps::write_patch_map(out.path(), result.patches);
  maps::write_timescale(out.path(), *result.timescale);
  if (earlier.map_from_truth) maps::write_map_from_truth(out.path(), *earlier.map_from_truth);
  report::Drawings drawings;
  pipeline::write_map_pictures(out.path(), result.slam, result.patches, drawings);
  std::string logs = earlier.log;
  for (const std::string& robot : robots) logs += (logs.empty() ? "" : " ") + robot;
  const pipeline::Cost cost = meter.read();
  nlohmann::json summary =
      maps::write_summary(out.path(), logs, {cost.wall_s, cost.cpu_s, cost.peak_rss_mb});
  out.commit();
  warn(context, drawings.what_is_missing());
  summary["visits"] = count;
  summary["robots"] = robots;
  return summary;
}

}  // namespace strata::tools
