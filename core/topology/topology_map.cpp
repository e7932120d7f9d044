// SPDX-License-Identifier: Apache-2.0
#include "core/topology/topology_map.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <utility>

#include "core/pose_graph/pose_graph.hpp"
#include "core/slam/slam.hpp"

namespace strata::topology {
namespace {

/// Information of a visit's frame hanging on its scan: a ruler.
constexpr double kRigid = 1e8;
/// Added to the information of a match: a corridor leaves its length open.
constexpr double kFloorInformation = 1e-3;

Eigen::Matrix3d path_information(double path_length_m, const PathNoiseConfig& noise) {
  const double root = std::sqrt(std::max(path_length_m, 0.05));
  const double m = 1.0 / (noise.per_root_metre_m * root);
  const double rad = 1.0 / (noise.per_root_metre_rad * root);
  return Eigen::Vector3d(m * m, m * m, rad * rad).asDiagonal();
}

/// A turn of one radian adds as much to the noise as a metre of way.
constexpr double kWayPerRadian_m = 1.0;

/// The nodes of the graph: some scans, each with an edge to the one before.
struct Chain {
  std::vector<std::size_t> node_of;      ///< of each scan: its own node or the last before it
  std::map<Stamp, std::size_t> node_at;  ///< of the scans that visits belong to
  std::vector<Pose2> before;             ///< of each node, as it was tracked
};

Chain add_chain(const std::vector<PosedScan>& scans, std::span<const MadeVisit> visits,
                const TopologyMapperConfig& config, pose_graph::PoseGraph& graph) {
  Chain chain;
  for (const MadeVisit& visit : visits) chain.node_at[visit.visit.stamp] = 0;
  std::size_t last_scan = 0;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const Pose2& pose = scans[i].map_from_robot;
    const Pose2 step = between(scans[last_scan].map_from_robot, pose);
    const auto visited = chain.node_at.find(scans[i].scan.stamp);
    const bool due = i == 0 || visited != chain.node_at.end() ||
                     has_moved(scans[last_scan].map_from_robot, pose, config.node_distance_m,
                               config.node_turn_rad);
    if (due) {
      const std::size_t node = graph.add_node(pose, i == 0);
      if (i > 0) {
        const double path_length_m =
            step.translation().norm() + kWayPerRadian_m * std::abs(step.theta);
        graph.add_edge({node - 1, node, step, path_information(path_length_m, config.way), false});
      }
      if (visited != chain.node_at.end()) visited->second = node;
      chain.before.push_back(pose);
      last_scan = i;
    }
    chain.node_of.push_back(graph.size() - 1);
  }
  return chain;
}

void add_visits(std::span<const MadeVisit> visits, const Hypothesis& hypothesis, const Chain& chain,
                pose_graph::PoseGraph& graph) {
  std::vector<std::size_t> visit_node;
  for (const MadeVisit& visit : visits) {
    const std::size_t robot = chain.node_at.at(visit.visit.stamp);
    const std::size_t node = graph.add_node(graph.pose(robot) * visit.robot_from_visit);
    graph.add_edge(
        {robot, node, visit.robot_from_visit, kRigid * Eigen::Matrix3d::Identity(), false});
    visit_node.push_back(node);
  }
  for (const ScanFactor& scan : hypothesis.scans) {
    if (!scan.match.converged) continue;
    const Eigen::Matrix3d& information = scan.match.information;
    graph.add_edge({visit_node[scan.from], visit_node[scan.to], scan.match.a_from_b,
                    0.5 * (information + information.transpose()) +
                        kFloorInformation * Eigen::Matrix3d::Identity(),
                    true});
  }
}

/// Loops are closed at landmarks only: between them the walls of two passes still lie apart, and
/// behind the last landmark nothing holds the way. SLAM with these poses as given ones registers
/// all passes to each other [lu1997globally], near where the topology puts them.
void register_passes(const TopologyMapperConfig& config, int threads, Progress* progress,
                     TopologyMap& result) {
  slam::SlamConfig closing;
  closing.tracking = config.tracking;
  closing.closure = config.closure;
  closing.given_poses = config.pose_prior;
  closing.em = slam::EmConfig{config.refinement, false};
  closing.beam_filter.resolution_m = config.resolution_m;
  slam::Slam slam(closing, threads);
  for (const PosedScan& scan : result.scans) {
    slam.add({scan.run, scan.scan, scan.map_from_robot, true}, &scan.map_from_robot);
  }
  slam::SlamResult registered = slam.finish(progress);
  // It skips a scan that comes twice, and says so by leaving it out.
  auto next = registered.scans.begin();
  for (PosedScan& scan : result.scans) {
    if (next == registered.scans.end() || next->scan.stamp != scan.scan.stamp) continue;
    scan.map_from_robot = next->map_from_robot;
    ++next;
  }
  result.map = std::move(registered.occupancy);
}

}  // namespace

TopologyMap make_topology_map(const TopologyMapper& mapper, Progress* progress) {
  const TopologyMapperConfig& config = mapper.config();
  TopologyMap result;
  result.visits = mapper.visits();
  result.posterior = mapper.posterior();
  result.place_names = mapper.place_names();
  result.counts = mapper.counts();
  result.scans = mapper.scans();
  for (const PosedScan& scan : result.scans) result.tracked.push_back(scan.map_from_robot);
  pose_graph::PoseGraph graph(config.pose_graph);
  const Chain chain = add_chain(result.scans, result.visits, config, graph);
  if (!result.posterior.empty()) {
    const Hypothesis& likeliest = result.posterior.front();
    result.locations = mapper.filter().locations(likeliest);
    add_visits(result.visits, likeliest, chain, graph);
  }
  result.optimized = graph.size() > 0 && graph.optimize().converged;
  for (std::size_t i = 0; i < result.scans.size(); ++i) {
    PosedScan& scan = result.scans[i];
    const std::size_t node = chain.node_of[i];
    scan.map_from_robot = graph.pose(node) * between(chain.before[node], scan.map_from_robot);
  }
  register_passes(config, mapper.threads(), progress, result);
  return result;
}

}  // namespace strata::topology
