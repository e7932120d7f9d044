// SPDX-License-Identifier: Apache-2.0
#include "tools/site/robot_check.hpp"

#include <algorithm>

#include "components/log/trajectory_file.hpp"
#include "tools/pipeline/map_fit.hpp"
#include "tools/report/plot.hpp"

namespace strata::site {
namespace {

bool is_judged(const RobotJudgement& robot) { return robot.scans >= pipeline::kFitWindow; }

std::optional<double> median_of_others(std::span<const RobotJudgement> robots, std::size_t but) {
  std::vector<double> shares;
  for (std::size_t i = 0; i < robots.size(); ++i) {
    if (i != but && is_judged(robots[i])) shares.push_back(robots[i].contradicted);
  }
  if (shares.empty()) return std::nullopt;
  std::sort(shares.begin(), shares.end());
  const std::size_t middle = shares.size() / 2;
  return shares.size() % 2 == 1 ? shares[middle] : (shares[middle - 1] + shares[middle]) / 2.0;
}

}  // namespace

RobotJudgement measure_robot(const ReflectionGrid& map, const RobotVisits& robot) {
  RobotJudgement found;
  found.robot = robot.robot;
  std::size_t contradicted = 0;
  for (const std::span<const PosedScan> visit : robot.visits) {
    std::vector<Observation> observations;
    std::vector<log::StampedPose> trajectory;
    for (const PosedScan& scan : visit) {
      observations.push_back({scan.run, scan.scan, {}, false});
      trajectory.push_back({scan.scan.stamp, scan.map_from_robot});
    }
    const pipeline::LogFit fit = pipeline::fit_of_trajectory(map, observations, trajectory);
    for (const pipeline::FittedScan& scan : fit.scans) {
      if (scan.fit == pipeline::FitState::kUnknown) continue;
      ++found.scans;
      if (scan.fit == pipeline::FitState::kContradicted) ++contradicted;
    }
  }
  if (found.scans > 0) {
    found.contradicted = static_cast<double>(contradicted) / static_cast<double>(found.scans);
  }
  return found;
}

std::vector<RobotJudgement> judge_robots(const ReflectionGrid& map,
                                         std::span<const RobotVisits> robots,
                                         const RobotLimits& limits) {
  std::vector<RobotJudgement> judged;
  for (const RobotVisits& robot : robots) judged.push_back(measure_robot(map, robot));
  for (std::size_t i = 0; i < judged.size(); ++i) {
    RobotJudgement& robot = judged[i];
    robot.others = median_of_others(judged, i);
    if (!is_judged(robot) || !robot.others) continue;
    if (robot.contradicted <= limits.max_contradicted ||
        robot.contradicted <= *robot.others + limits.max_above_others) {
      continue;
    }
    robot.why = report::percent(robot.contradicted, 0) +
                " of its scans contradict the active version, " +
                report::percent(*robot.others, 0) + " of the other robots'";
  }
  return judged;
}

}  // namespace strata::site
