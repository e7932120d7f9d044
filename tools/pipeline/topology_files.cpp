// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/topology_files.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <sstream>
#include <utility>

#include "components/log/map_file.hpp"
#include "components/log/trajectory_file.hpp"
#include "tools/report/map_picture.hpp"

namespace strata::pipeline {
namespace {

constexpr int kMapPixels = 1400;
constexpr std::size_t kTopologiesDrawn = 6;

/// How often the robot drove between two landmarks, by their labels.
std::map<std::pair<int, int>, int> traversals(const topology::Labels& labels) {
  std::map<std::pair<int, int>, int> edges;
  for (std::size_t i = 1; i < labels.size(); ++i) {
    if (labels[i] == labels[i - 1]) continue;
    ++edges[std::minmax({labels[i - 1], labels[i]})];
  }
  return edges;
}

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

ReflectionGrid map_by(const std::vector<PosedScan>& scans, const std::vector<Pose2>& poses,
                      double resolution_m) {
  CountingMap counts(resolution_m);
  for (std::size_t i = 0; i < scans.size(); i += 3) {
    PosedScan scan = scans[i];
    scan.map_from_robot = poses[i];
    counts.add(scan);
  }
  return counts.reflection();
}

void write_map_picture(const std::filesystem::path& path, const ReflectionGrid& map,
                       const std::vector<Pose2>& poses) {
  report::MapPicture picture = report::draw_map(map, report::known_rect(map), kMapPixels);
  report::mark_trajectory(picture, poses, {220, 30, 30});
  report::write_file(path, report::encode_png(picture.image));
}

}  // namespace

nlohmann::json topology_json(const topology::Hypothesis& hypothesis,
                             const std::vector<Pose2Gaussian>& locations) {
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
                             const std::vector<Pose2Gaussian>& locations) {
  std::ostringstream out;
  out.precision(9);
  out << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
         "<graphml xmlns=\"http://graphml.graphdrawing.org/xmlns\">\n";
  for (const char* name : {"x", "y", "theta", "var_x", "cov_xy", "var_y"}) {
    out << "  <key id=\"" << name << "\" for=\"node\" attr.name=\"" << name
        << "\" attr.type=\"double\"/>\n";
  }
  out << "  <key id=\"visits\" for=\"node\" attr.name=\"visits\" attr.type=\"int\"/>\n"
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

nlohmann::json write_topology(const std::filesystem::path& dir, const std::string& log,
                              const TopologyMap& result, const Cost& cost,
                              const std::optional<TopologyAgreement>& agreement) {
  const Stamp begin = result.scans.front().scan.stamp;
  nlohmann::json visits = nlohmann::json::array();
  for (std::size_t i = 0; i < result.visits.size(); ++i) {
    const topology::LandmarkVisit& visit = result.visits[i].visit;
    const Pose2& pose = result.locations[i].mean;
    visits.push_back({{"time_s", (visit.stamp - begin).seconds()},
                      {"x", pose.x},
                      {"y", pose.y},
                      {"theta", pose.theta},
                      {"way_m", visit.way_m},
                      {"patch_points", visit.patch.size()}});
  }
  nlohmann::json topologies = nlohmann::json::array();
  for (std::size_t i = 0; i < result.posterior.size(); ++i) {
    topologies.push_back(topology_json(result.posterior[i],
                                       i == 0 ? result.locations : std::vector<Pose2Gaussian>{}));
  }
  const topology::TopologyCounts& counts = result.counts;
  nlohmann::json json{
      {"log", log},
      {"scans", result.scans.size()},
      {"visits", std::move(visits)},
      {"topologies", std::move(topologies)},
      {"diagnostics",
       {{"skipped_visits", counts.skipped_visits},
        {"empty_patches", counts.empty_patches},
        {"failed_matches", counts.failed_matches},
        {"not_converged", counts.not_converged},
        {"metric_map_converged", result.optimized}}},
      {"cost",
       {{"wall_s", cost.wall_s},
        {"cpu_s", cost.cpu_s},
        {"peak_rss_mb", cost.peak_rss_mb},
        {"update_ms",
         {{"median", median(result.update_ms)},
          {"max", result.update_ms.empty()
                      ? 0.0
                      : *std::max_element(result.update_ms.begin(), result.update_ms.end())}}}}}};
  if (agreement) {
    json["agreement"] = {{"near", agreement->near},
                         {"near_merged", agreement->near_merged},
                         {"far", agreement->far},
                         {"far_merged", agreement->far_merged}};
  }
  report::write_file(dir / "topologies.json", json.dump(2) + "\n");
  report::write_file(dir / "topology.graphml",
                     topology_graphml(result.posterior.front(), result.locations));
  log::write_map(dir / "occupancy.yaml", result.map);
  std::vector<log::StampedPose> trajectory;
  std::vector<Pose2> poses;
  for (const PosedScan& scan : result.scans) {
    trajectory.push_back({scan.scan.stamp, scan.map_from_robot});
    poses.push_back(scan.map_from_robot);
  }
  log::write_trajectory(dir / "trajectory.tum", trajectory);
  write_map_picture(dir / "map.png", result.map, poses);
  write_map_picture(dir / "odometry.png",
                    map_by(result.scans, result.tracked, result.map.resolution_m()),
                    result.tracked);
  report::write_file(dir / "topologies.png",
                     report::render_svg_to_png(draw_topologies(result, kTopologiesDrawn), 1.0));
  report::write_file(dir / "landmarks.png", report::render_svg_to_png(draw_landmarks(result), 1.0));
  return json;
}

}  // namespace strata::pipeline
