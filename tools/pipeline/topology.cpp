// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/topology.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>
#include <utility>

#include "core/base/error.hpp"
#include "core/grid/counting_map.hpp"
#include "core/slam/tracker.hpp"

namespace strata::pipeline {
namespace {

/// Information of a visit's frame hanging on its scan: a ruler.
constexpr double kRigid = 1e8;
/// Added to the information of a match: a corridor leaves its length open.
constexpr double kFloorInformation = 1e-3;

std::vector<PosedScan> track(const std::vector<Observation>& observations,
                             const std::vector<std::optional<Pose2>>& given,
                             const TopologyMapConfig& config, Progress* progress) {
  std::vector<PosedScan> scans;
  if (observations.empty()) return scans;
  slam::Tracker tracker(config.tracking, config.resolution_m, observations.front().run,
                        observations.front().odom_from_robot);
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const Observation& observation = observations[i];
    if (observation.run != observations.front().run) break;
    const bool late = scans.empty() || scans.back().scan.stamp < observation.scan.stamp;
    report_progress(progress, "match scans", i + 1, observations.size());
    if (!late || (observation.has_odometry && !is_finite(observation.odom_from_robot))) continue;
    PosedScan scan{observation.run, observation.scan, observation.odom_from_robot, {}};
    if (i < given.size() && given[i]) {
      scan.map_from_robot = *given[i];
    } else if (config.match_scans) {
      const Pose2* odometry = observation.has_odometry ? &observation.odom_from_robot : nullptr;
      scan.map_from_robot = tracker.add(observation.scan, odometry, i).run_from_robot.mean;
      (void)tracker.take_finished();
    }
    scans.push_back(std::move(scan));
  }
  return scans;
}

void follow_landmarks(std::optional<std::span<const double>> times_s,
                      const TopologyMapConfig& config, std::uint64_t seed, int threads,
                      Progress* progress, TopologyMap& result) {
  topology::VisitConfig visit_config = config.landmarks;
  if (times_s) visit_config.source = topology::LandmarkSource::kGiven;
  topology::VisitMaker maker(visit_config);
  topology::TopologyFilter filter(config.topology, seed, threads);
  if (times_s && !result.scans.empty()) {
    const Stamp begin = result.scans.front().scan.stamp;
    for (const double time_s : *times_s) maker.mark(begin + Duration::from_seconds(time_s));
  }
  const auto take = [&](std::vector<topology::MadeVisit> visits) {
    for (topology::MadeVisit& made : visits) {
      const auto begin = std::chrono::steady_clock::now();
      if (!filter.add(made.visit)) continue;
      const std::chrono::duration<double, std::milli> took =
          std::chrono::steady_clock::now() - begin;
      result.update_ms.push_back(took.count());
      result.visits.push_back(std::move(made));
    }
  };
  for (std::size_t i = 0; i < result.scans.size(); ++i) {
    take(maker.add(result.scans[i]));
    report_progress(progress, "follow landmarks", i + 1, result.scans.size());
  }
  take(maker.finish());
  result.posterior = filter.posterior();
  result.counts = filter.counts();
  if (!result.posterior.empty()) result.locations = filter.locations(result.posterior.front());
}

Eigen::Matrix3d way_information(double way_m, const WayNoiseConfig& noise) {
  const double root = std::sqrt(std::max(way_m, 0.05));
  const double m = 1.0 / (noise.per_root_metre_m * root);
  const double rad = 1.0 / (noise.per_root_metre_rad * root);
  return Eigen::Vector3d(m * m, m * m, rad * rad).asDiagonal();
}

/// Lu and Milios [lu1997globally]: consecutive scans and visits of one landmark hold each other.
void optimize(const TopologyMapConfig& config, TopologyMap& result) {
  pose_graph::PoseGraph graph(config.pose_graph);
  std::map<Stamp, std::size_t> scan_at;  // by stamp, of visits
  for (const topology::MadeVisit& visit : result.visits) scan_at[visit.visit.stamp] = 0;
  std::vector<std::size_t> node_of(result.scans.size(), 0);
  std::size_t last_scan = 0;
  for (std::size_t i = 0; i < result.scans.size(); ++i) {
    const Pose2& pose = result.scans[i].map_from_robot;
    const Pose2 step = between(result.scans[last_scan].map_from_robot, pose);
    const auto visited = scan_at.find(result.scans[i].scan.stamp);
    const bool due = i == 0 || step.translation().norm() >= config.node_distance_m ||
                     std::abs(step.theta) >= config.node_distance_m || visited != scan_at.end();
    if (!due) {
      node_of[i] = graph.size() - 1;
      continue;
    }
    const std::size_t node = graph.add_node(pose, i == 0);
    if (i > 0) {
      const double way_m = step.translation().norm() + std::abs(step.theta);
      graph.add_edge({node - 1, node, step, way_information(way_m, config.way), false});
    }
    if (visited != scan_at.end()) visited->second = node;
    node_of[i] = node;
    last_scan = i;
  }
  // Where each node's own scan was, for the scans between nodes.
  std::vector<Pose2> before;
  for (std::size_t node = 0; node < graph.size(); ++node) before.push_back(graph.pose(node));
  std::vector<std::size_t> visit_node;
  for (const topology::MadeVisit& visit : result.visits) {
    const std::size_t robot = scan_at[visit.visit.stamp];
    const std::size_t node = graph.add_node(graph.pose(robot) * visit.robot_from_visit);
    graph.add_edge(
        {robot, node, visit.robot_from_visit, kRigid * Eigen::Matrix3d::Identity(), false});
    visit_node.push_back(node);
  }
  for (const topology::ScanFactor& scan : result.posterior.front().scans) {
    if (!scan.match.converged) continue;
    const Eigen::Matrix3d& information = scan.match.information;
    graph.add_edge({visit_node[scan.from], visit_node[scan.to], scan.match.a_from_b,
                    0.5 * (information + information.transpose()) +
                        kFloorInformation * Eigen::Matrix3d::Identity(),
                    true});
  }
  // Start where the topology has the landmarks; the chain between them follows.
  result.optimized = graph.optimize().converged;
  for (std::size_t i = 0; i < result.scans.size(); ++i) {
    Pose2& pose = result.scans[i].map_from_robot;
    pose = graph.pose(node_of[i]) * between(before[node_of[i]], pose);
  }
}

}  // namespace

TopologyMap map_topology(const std::vector<Observation>& observations,
                         const std::vector<std::optional<Pose2>>& given,
                         std::optional<std::span<const double>> landmark_times_s,
                         const TopologyMapConfig& config, std::uint64_t seed, int threads,
                         Progress* progress) {
  TopologyMap result;
  result.scans = track(observations, given, config, progress);
  for (const PosedScan& scan : result.scans) result.tracked.push_back(scan.map_from_robot);
  follow_landmarks(landmark_times_s, config, seed, threads, progress, result);
  if (result.visits.size() < 2) {
    throw InputError("the log", "has " + std::to_string(result.visits.size()) + " landmarks",
                     "give --landmarks, or lower landmarks.detector.min_prominence");
  }
  optimize(config, result);
  CountingMap counts(config.resolution_m);
  for (std::size_t i = 0; i < result.scans.size(); ++i) {
    counts.add(result.scans[i]);
    report_progress(progress, "draw the map", i + 1, result.scans.size());
  }
  result.map = counts.reflection();
  return result;
}

TopologyAgreement agreement(const TopologyMap& result, const topology::Hypothesis& hypothesis,
                            const std::vector<Observation>& observations,
                            const std::vector<std::optional<Pose2>>& truths, double near_m) {
  std::map<Stamp, Pose2> true_poses;
  for (std::size_t i = 0; i < std::min(observations.size(), truths.size()); ++i) {
    if (truths[i]) true_poses[observations[i].scan.stamp] = *truths[i];
  }
  TopologyAgreement agreement;
  std::vector<std::optional<Pose2>> places;
  for (const topology::MadeVisit& visit : result.visits) {
    const auto pose = true_poses.find(visit.visit.stamp);
    places.emplace_back();
    if (pose != true_poses.end()) places.back() = pose->second * visit.robot_from_visit;
  }
  for (std::size_t b = 1; b < places.size(); ++b) {
    for (std::size_t a = 0; a < b && places[b]; ++a) {
      if (!places[a]) continue;
      const double apart_m = translation_distance(*places[a], *places[b]);
      const bool merged = hypothesis.labels[a] == hypothesis.labels[b];
      if (apart_m <= near_m) {
        ++agreement.near;
        agreement.near_merged += merged ? 1 : 0;
      } else if (apart_m >= 2.0 * near_m) {
        ++agreement.far;
        agreement.far_merged += merged ? 1 : 0;
      }
    }
  }
  return agreement;
}

std::vector<double> read_landmark_times(const std::string& path) {
  std::ifstream in(path);
  if (!in) throw InputError(path, "cannot be read", "check the name and its permissions");
  std::vector<double> times_s;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    line.resize(std::min(line.size(), line.find('#')));
    std::istringstream words(line);
    double time_s = 0.0;
    std::string rest;
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    if (!(words >> time_s) || !std::isfinite(time_s) || words >> rest) {
      throw InputError(path + ":" + std::to_string(number), "is no time",
                       "write one time a line, in seconds from the first scan");
    }
    times_s.push_back(time_s);
  }
  return times_s;
}

}  // namespace strata::pipeline
