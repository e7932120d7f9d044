// SPDX-License-Identifier: Apache-2.0
#include "tools/site/new_run_check.hpp"

#include <algorithm>
#include <string>

#include "components/maps/earlier_runs.hpp"
#include "components/maps/maps_folder.hpp"
#include "tools/pipeline/map_fit.hpp"
#include "tools/report/plot.hpp"
#include "tools/site/robot_check.hpp"

namespace strata::site {
namespace {

/// A recording that contradicts less than a run by more than this does not excuse it: a robot that
/// finds its place makes the best of a map, as one whose poses are given does not.
constexpr double kMaxLess = 0.1;

}  // namespace

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
    judged.push_back({run.front().run, found.scans, found.contradicted, {}});
    for (const PosedScan& scan : run) judged.back().period.add(scan.scan.stamp);
  }
  return judged;
}

void check_new_runs(const std::vector<NewRun>& runs, const GateConfig& config, GateReport& report) {
  const double most = config.max_new_contradicted;
  for (const NewRun& run : runs) {
    const bool is_much = run.contradicted > most;
    const bool others_too =
        std::any_of(report.logs.begin(), report.logs.end(), [&](const GateLog& log) {
          return log.active && log.active->contradicted > most &&
                 log.active->contradicted >= run.contradicted - kMaxLess &&
                 !log.period.overlaps(run.period);
        });
    const std::string why = !is_much ? ""
                            : others_too
                                ? ", as a recording does: the building changed"
                                : ", and no recording of another drive does as much: another "
                                  "building, a wrong place, or it was rebuilt since";
    report.checks.push_back({"new run", "", !is_much || others_too,
                             report::percent(run.contradicted, 1) +
                                 " of the scans of its new run " + std::to_string(run.run) +
                                 " contradict the active version (most " +
                                 report::percent(most, 1) + ")" + why});
  }
}

}  // namespace strata::site
