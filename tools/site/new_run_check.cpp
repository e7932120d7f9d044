// SPDX-License-Identifier: Apache-2.0
#include "tools/site/new_run_check.hpp"

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
  std::vector<NewRun> judged;
  for (const std::vector<PosedScan>& run : runs) {
    const RobotJudgement found = measure_robot(filtered, {"", {run}});
    if (found.scans < pipeline::kFitWindow) continue;
    judged.push_back({run.front().run, found.scans, found.contradicted});
  }
  return judged;
}

}  // namespace strata::site
