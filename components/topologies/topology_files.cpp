// SPDX-License-Identifier: Apache-2.0
#include "components/topologies/topology_files.hpp"

#include <algorithm>
#include <map>
#include <sstream>
#include <utility>
#include <vector>

#include "components/log/json_text.hpp"
#include "components/log/map_file.hpp"
#include "components/log/trajectory_file.hpp"
#include "components/log/whole_file.hpp"
#include "components/maps/maps_folder.hpp"

namespace strata::topologies {
namespace {

/// How often the robot drove between two landmarks, by their labels.
std::map<std::pair<int, int>, int> traversals(const topology::Labels& labels) {
  std::map<std::pair<int, int>, int> edges;
  for (std::size_t i = 1; i < labels.size(); ++i) {
    if (labels[i] == labels[i - 1]) continue;
    ++edges[std::minmax({labels[i - 1], labels[i]})];
  }
  return edges;
}

void write_text(const std::filesystem::path& path, const std::string& text) {
  log::WholeFile file(path);
  file.stream() << text;
  file.commit();
}

/// As people see it.
std::string place_name(const std::vector<int>& names, int label) {
  return "place " + std::to_string(names[static_cast<std::size_t>(label)]);
}

}  // namespace

nlohmann::json topology_json(const topology::Hypothesis& hypothesis,
                             const std::vector<Pose2Gaussian>& locations,
                             const std::vector<int>& names) {
  nlohmann::json landmarks = nlohmann::json::array();
  for (const std::size_t first : topology::first_visits(hypothesis.labels)) {
    const Pose2& pose = hypothesis.poses[first];
    std::vector<std::size_t> visits;
    for (std::size_t i = 0; i < hypothesis.labels.size(); ++i) {
      if (hypothesis.labels[i] == hypothesis.labels[first]) visits.push_back(i);
    }
    nlohmann::json landmark{{"id", hypothesis.labels[first]},
                            {"x", pose.x},
                            {"y", pose.y},
                            {"theta", pose.theta},
                            {"visits", visits}};
    if (!names.empty()) landmark["name"] = place_name(names, hypothesis.labels[first]);
    if (first < locations.size()) {
      const Eigen::Matrix3d& c = locations[first].covariance;
      landmark["covariance"] = {
          {c(0, 0), c(0, 1), c(0, 2)}, {c(1, 0), c(1, 1), c(1, 2)}, {c(2, 0), c(2, 1), c(2, 2)}};
    }
    landmarks.push_back(std::move(landmark));
  }
  nlohmann::json edges = nlohmann::json::array();
  for (const auto& [pair, count] : traversals(hypothesis.labels)) {
    edges.push_back({{"from", pair.first}, {"to", pair.second}, {"traversals", count}});
  }
  return {{"probability", hypothesis.probability},
          {"log_evidence", hypothesis.log_evidence},
          {"labels", hypothesis.labels},
          {"landmarks", std::move(landmarks)},
          {"edges", std::move(edges)}};
}

std::string topology_graphml(const topology::Hypothesis& hypothesis,
                             const std::vector<Pose2Gaussian>& locations,
                             const std::vector<int>& names) {
  std::ostringstream out;
  out.precision(9);
  out << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
         "<graphml xmlns=\"http://graphml.graphdrawing.org/xmlns\">\n";
  for (const char* name : {"x", "y", "theta", "var_x", "cov_xy", "var_y"}) {
    out << "  <key id=\"" << name << "\" for=\"node\" attr.name=\"" << name
        << "\" attr.type=\"double\"/>\n";
  }
  out << "  <key id=\"name\" for=\"node\" attr.name=\"name\" attr.type=\"string\"/>\n"
         "  <key id=\"visits\" for=\"node\" attr.name=\"visits\" attr.type=\"int\"/>\n"
         "  <key id=\"traversals\" for=\"edge\" attr.name=\"traversals\" attr.type=\"int\"/>\n"
         "  <key id=\"probability\" for=\"graph\" attr.name=\"probability\" "
         "attr.type=\"double\"/>\n"
         "  <graph id=\"topology\" edgedefault=\"undirected\">\n"
         "    <data key=\"probability\">"
      << hypothesis.probability << "</data>\n";
  const auto data = [&](const char* key, auto value) {
    out << "<data key=\"" << key << "\">" << value << "</data>";
  };
  for (const std::size_t first : topology::first_visits(hypothesis.labels)) {
    const int label = hypothesis.labels[first];
    out << "    <node id=\"n" << label << "\">";
    if (!names.empty()) data("name", place_name(names, label));
    data("x", hypothesis.poses[first].x);
    data("y", hypothesis.poses[first].y);
    data("theta", hypothesis.poses[first].theta);
    if (first < locations.size()) {
      data("var_x", locations[first].covariance(0, 0));
      data("cov_xy", locations[first].covariance(0, 1));
      data("var_y", locations[first].covariance(1, 1));
    }
    data("visits", std::count(hypothesis.labels.begin(), hypothesis.labels.end(), label));
    out << "</node>\n";
  }
  for (const auto& [pair, count] : traversals(hypothesis.labels)) {
    out << "    <edge source=\"n" << pair.first << "\" target=\"n" << pair.second << "\">";
    data("traversals", count);
    out << "</edge>\n";
  }
  out << "  </graph>\n</graphml>\n";
  return out.str();
}

nlohmann::json topologies_json(const topology::TopologyMap& map) {
  nlohmann::json visits = nlohmann::json::array();
  for (std::size_t i = 0; i < map.visits.size(); ++i) {
    const topology::LandmarkVisit& visit = map.visits[i].visit;
    const Pose2& pose = map.locations[i].mean;
    visits.push_back({{"time_s", (visit.stamp - map.scans.front().scan.stamp).seconds()},
                      {"x", pose.x},
                      {"y", pose.y},
                      {"theta", pose.theta},
                      {"way_m", visit.path_length_m},
                      {"patch_points", visit.cloud.size()}});
  }
  nlohmann::json topologies = nlohmann::json::array();
  for (std::size_t i = 0; i < map.posterior.size(); ++i) {
    topologies.push_back(i == 0 ? topology_json(map.posterior[i], map.locations, map.place_names)
                                : topology_json(map.posterior[i], {}));
  }
  const topology::TopologyCounts& counts = map.counts;
  return {{"scans", map.scans.size()},
          {"visits", std::move(visits)},
          {"topologies", std::move(topologies)},
          {"diagnostics",
           {{"late_visits", counts.late_visits},
            {"broken_visits", counts.broken_visits},
            {"empty_patches", counts.empty_clouds},
            {"failed_matches", counts.failed_matches},
            {"not_converged", counts.not_converged},
            {"near_landmarks", counts.near_landmarks},
            {"metric_map_converged", map.optimized}}}};
}

std::string places_yaml(const topology::Hypothesis& hypothesis) {
  std::ostringstream out;
  out << "# Places of the likeliest topology, for sub-maps that follow them:\n"
         "#   strata learn LOG --config places.yaml --out MAPS\n"
         "version: 1\npatch:\n  regions:\n    places: [";
  const char* separator = "";
  for (const std::size_t first : topology::first_visits(hypothesis.labels)) {
    out << separator << hypothesis.poses[first].x << ", " << hypothesis.poses[first].y;
    separator = ", ";
  }
  out << "]\n";
  return out.str();
}

void write_topology_files(const std::filesystem::path& dir, const topology::TopologyMap& map,
                          const nlohmann::json& json) {
  write_text(dir / "topologies.json", log::json_text(json));
  if (!map.posterior.empty()) {
    write_text(dir / "topology.graphml",
               topology_graphml(map.posterior.front(), map.locations, map.place_names));
    write_text(dir / "places.yaml", places_yaml(map.posterior.front()));
  }
  log::write_map(dir / "occupancy.yaml", map.map);
  std::vector<log::StampedPose> trajectory;
  for (const PosedScan& scan : map.scans) {
    trajectory.push_back({scan.scan.stamp, scan.map_from_robot});
  }
  log::write_trajectory(dir / maps::kTrajectoryFile, trajectory);
}

}  // namespace strata::topologies
