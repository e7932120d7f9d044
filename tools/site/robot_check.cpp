// SPDX-License-Identifier: Apache-2.0
#include "tools/site/robot_check.hpp"

#include <algorithm>

#include "components/log/trajectory_file.hpp"
#include "tools/pipeline/map_fit.hpp"
#include "tools/report/plot.hpp"

namespace strata::site {
namespace {

template <class Judgement>
bool is_judged(const Judgement& judgement) {
  return judgement.scans >= pipeline::kFitWindow;
}

/// Those of these visits as one.
template <class IsOne>
VisitJudgement together(std::span<const VisitJudgement> visits, const IsOne& is_one) {
  VisitJudgement all;
  double contradicted = 0.0;
  for (const VisitJudgement& visit : visits) {
    if (!is_one(visit)) continue;
    all.scans += visit.scans;
    contradicted += visit.contradicted * static_cast<double>(visit.scans);
  }
  if (all.scans > 0) all.contradicted = contradicted / static_cast<double>(all.scans);
  return all;
}

/// Why nothing is to be learned from what contradicts the map so much; empty: nothing speaks
/// against it.
std::string fault_of(const VisitJudgement& visit, double others, const RobotLimits& limits) {
  if (!is_judged(visit) || visit.contradicted <= limits.max_contradicted ||
      visit.contradicted <= others + limits.max_above_others) {
    return "";
  }
  return report::percent(visit.contradicted, 0) + " of its scans contradict the active version, " +
         report::percent(others, 0) + " of the other robots'";
}

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
  for (const std::span<const PosedScan> visit : robot.visits) {
    VisitJudgement judged;
    std::size_t contradicted = 0;
    std::vector<Observation> observations;
    std::vector<log::StampedPose> trajectory;
    for (const PosedScan& scan : visit) {
      observations.push_back({scan.run, scan.scan, {}, false});
      trajectory.push_back({scan.scan.stamp, scan.map_from_robot});
    }
    const pipeline::LogFit fit = pipeline::fit_of_trajectory(map, observations, trajectory);
    for (const pipeline::FittedScan& scan : fit.scans) {
      if (scan.fit == pipeline::FitState::kUnknown) continue;
      ++judged.scans;
      if (scan.fit == pipeline::FitState::kContradicted) ++contradicted;
    }
    if (judged.scans > 0) {
      judged.contradicted = static_cast<double>(contradicted) / static_cast<double>(judged.scans);
    }
    found.visits.push_back(judged);
  }
  const VisitJudgement all = together(found.visits, [](const VisitJudgement&) { return true; });
  found.scans = all.scans;
  found.contradicted = all.contradicted;
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
    if (!robot.others) continue;
    const VisitJudgement small =
        together(robot.visits, [](const VisitJudgement& visit) { return !is_judged(visit); });
    std::size_t wrong = 0;
    for (VisitJudgement& visit : robot.visits) {
      if (visit.scans == 0) continue;
      visit.why = fault_of(is_judged(visit) ? visit : small, *robot.others, limits);
      if (visit.why.empty()) continue;
      ++wrong;
      if (2 * wrong > robot.visits.size()) robot.why = visit.why;
    }
  }
  return judged;
}

}  // namespace strata::site
