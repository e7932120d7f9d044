// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/topology_files.hpp"

#include <algorithm>

#include "components/topologies/topology_files.hpp"
#include "core/grid/counting_map.hpp"
#include "tools/report/map_picture.hpp"

namespace strata::pipeline {
namespace {

constexpr int kMapPixels = 1400;
constexpr std::size_t kTopologiesDrawn = 6;

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

nlohmann::json write_topology(const std::filesystem::path& dir, const std::string& log,
                              const TopologyMap& result, const Cost& cost,
                              const std::optional<TopologyAgreement>& agreement) {
  nlohmann::json json = topologies::topologies_json(result);
  json["log"] = log;
  json["cost"] = {
      {"wall_s", cost.wall_s},
      {"cpu_s", cost.cpu_s},
      {"peak_rss_mb", cost.peak_rss_mb},
      {"update_ms",
       {{"median", median(result.update_ms)},
        {"max", result.update_ms.empty()
                    ? 0.0
                    : *std::max_element(result.update_ms.begin(), result.update_ms.end())}}}};
  if (agreement) {
    json["agreement"] = {{"near", agreement->near},
                         {"near_merged", agreement->near_merged},
                         {"unclear", agreement->unclear},
                         {"unclear_merged", agreement->unclear_merged},
                         {"between", agreement->between},
                         {"between_merged", agreement->between_merged},
                         {"between_chained", agreement->between_chained},
                         {"far", agreement->far},
                         {"far_merged", agreement->far_merged}};
  }
  topologies::write_topology_files(dir, result, json);
  return json;
}

void write_topology_pictures(const std::filesystem::path& dir, const TopologyMap& result,
                             report::Drawings& drawings) {
  const auto add = [&](const char* name, const auto& draw) {
    drawings.add(dir / name, [&] { draw(dir / name); });
  };
  add("map.png", [&](const std::filesystem::path& file) {
    std::vector<Pose2> poses;
    for (const PosedScan& scan : result.scans) poses.push_back(scan.map_from_robot);
    write_map_picture(file, result.map, poses);
  });
  add("odometry.png", [&](const std::filesystem::path& file) {
    write_map_picture(file, map_by(result.scans, result.tracked, result.map.resolution_m()),
                      result.tracked);
  });
  add("topologies.png", [&](const std::filesystem::path& file) {
    report::write_file(file,
                       report::render_svg_to_png(draw_topologies(result, kTopologiesDrawn), 1.0));
  });
  add("landmarks.png", [&](const std::filesystem::path& file) {
    report::write_file(file, report::render_svg_to_png(draw_landmarks(result), 1.0));
  });
}

}  // namespace strata::pipeline
