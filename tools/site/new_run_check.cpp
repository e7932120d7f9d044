// SPDX-License-Identifier: Apache-2.0
#include "tools/site/new_run_check.hpp"

#include <string>
#include <utility>

#include "components/maps/earlier_runs.hpp"
#include "components/maps/maps_folder.hpp"
#include "tools/pipeline/map_fit.hpp"
#include "tools/site/robot_check.hpp"

namespace strata::site {

std::vector<NewRun> judge_new_runs(const std::filesystem::path& candidate,
                                   const std::filesystem::path& active,
                                   const ReflectionGrid& filtered) {
  for (const std::filesystem::path& maps : {candidate, active}) {
    if (maps::open_for_reading(maps).runs_with_scans().empty()) return {};
  }
  const auto runs =
      maps::new_runs(maps::read_earlier_runs(candidate), maps::read_earlier_runs(active));
  std::vector<RobotVisits> visits;
  for (const std::vector<PosedScan>& run : runs) {
    visits.push_back({std::to_string(run.front().run), {run}});
  }
  std::vector<NewRun> judged;
  const std::vector<RobotJudgement> found = judge_robots(filtered, visits, {});
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found[i].scans < pipeline::kFitWindow) continue;
    judged.push_back({runs[i].front().run, found[i].scans, found[i].contradicted});
  }
  return judged;
}

}  // namespace strata::site
