// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/volume.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "components/log/map_file.hpp"
#include "components/log/text.hpp"
#include "core/base/error.hpp"
#include "core/base/parallel.hpp"
#include "core/volume/slice.hpp"
#include "tools/report/html_report.hpp"
#include "tools/report/volume_picture.hpp"

namespace fs = std::filesystem;

namespace strata::pipeline {
namespace {

constexpr int kPicturePixels = 1000;

/// Where to cut off the ceiling, which hides everything from above: a little below what the first
/// sensor pose has above it; under the open sky at three quarters of the map's height.
double cut_height(const VolumeResult& result) {
  const volume::VolumeMap& map = result.map;
  const double step_m = map.lattice().resolution_m();
  if (!result.sensor_poses.empty()) {
    const Eigen::Vector3d from = result.sensor_poses.front().translation;
    for (double up_m = 5.0 * step_m; up_m < 6.0; up_m += step_m) {
      const auto log_odds = map.log_odds(from + Eigen::Vector3d(0.0, 0.0, up_m));
      if (log_odds && map.is_occupied(*log_odds)) return from.z() + 0.85 * up_m;
    }
  }
  std::vector<double> heights;
  map.for_each_cube([&](const volume::VoxelCube& cube) {
    if (cube.is_occupied) heights.push_back(map.lattice().center_m(cube.corner.z));
  });
  if (heights.empty()) return 0.0;
  std::sort(heights.begin(), heights.end());
  const auto quantile = [&](double share) {
    return heights[static_cast<std::size_t>(share * static_cast<double>(heights.size() - 1))];
  };
  return quantile(0.02) + 0.75 * (quantile(0.98) - quantile(0.02));
}

void add_pictures(report::HtmlReport& page, const VolumeResult& result) {
  const double cut_m = cut_height(result);
  const auto cubes = report::occupied_cubes(result.map, cut_m);
  const std::string below = "What lies below " +
                            log::format_number(std::round(10.0 * cut_m) / 10.0) +
                            " m, coloured by height.";
  page.picture("above", report::draw_cubes(cubes, report::view_from_above(cubes, kPicturePixels)),
               "the map from above, without its ceiling", below);
  const double pi = std::numbers::pi;
  int number = 0;
  for (const double azimuth : {-0.75 * pi, 0.25 * pi}) {
    const auto view = report::view_from_outside(cubes, azimuth, 0.22 * pi, kPicturePixels);
    page.picture("outside_" + std::to_string(++number), report::draw_cubes(cubes, view),
                 "the map obliquely from outside, without its ceiling", below);
  }
  if (result.sensor_poses.empty()) return;
  const Pose3& pose = result.sensor_poses.front();
  report::VolumeView inside;
  inside.from_m = pose.translation;
  inside.towards_m = pose * Eigen::Vector3d::UnitX().eval();
  inside.field_of_view_rad = 0.55 * pi;
  page.picture("inside", report::draw_cubes(report::occupied_cubes(result.map), inside),
               "the map as the sensor saw it from its first pose",
               "Seen along x of the first pose.");
}

nlohmann::json counts_json(const volume::CloudCounts& counts) {
  return {{"total", counts.points},
          {"dynamic", counts.dynamic},
          {"not_finite", counts.not_finite},
          {"beyond_range", counts.beyond_range},
          {"outside", counts.outside}};
}

nlohmann::json make_summary(const std::string& log, const VolumeResult& result, const Cost& cost) {
  const volume::VolumeSize size = result.map.size();
  std::size_t occupied = 0;
  std::size_t free = 0;
  result.map.for_each_cube([&](const volume::VoxelCube& cube) {
    const auto edge = static_cast<std::size_t>(cube.edge);
    (cube.is_occupied ? occupied : free) += edge * edge * edge;
  });
  const std::size_t known = occupied + free;
  return {{"log", log},
          {"format", result.report.format},
          {"clouds", result.report.clouds},
          {"skipped",
           {{"bad_lines", result.report.bad_lines},
            {"first_bad", result.report.first_bad},
            {"clouds_without_pose", result.report.clouds_without_pose},
            {"points_without_pose", result.report.points_without_pose}}},
          {"points", counts_json(result.counts)},
          {"filtered", result.is_filtered},
          {"resolution_m", result.map.config().resolution_m},
          {"nodes", size.nodes},
          {"leaves", size.leaves},
          {"bytes", size.bytes},
          {"voxels", {{"occupied", occupied}, {"free", free}}},
          {"bytes_per_voxel",
           known == 0 ? 0.0 : static_cast<double>(size.bytes) / static_cast<double>(known)},
          {"cost",
           {{"wall_s", cost.wall_s}, {"cpu_s", cost.cpu_s}, {"peak_rss_mb", cost.peak_rss_mb}}}};
}

report::Table table_of(const nlohmann::json& summary) {
  const auto text = [&](const nlohmann::json& value) { return value.dump(); };
  return {{"what", "how much"},
          {{"clouds", text(summary["clouds"])},
           {"points", text(summary["points"]["total"])},
           {"taken for moving", text(summary["points"]["dynamic"])},
           {"voxel edge [m]", text(summary["resolution_m"])},
           {"occupied voxels", text(summary["voxels"]["occupied"])},
           {"free voxels", text(summary["voxels"]["free"])},
           {"nodes of the octree", text(summary["nodes"])},
           {"bytes", text(summary["bytes"])}},
          "The map in numbers."};
}

}  // namespace

VolumeResult make_volume(const fs::path& log, const VolumeJobConfig& config, bool filter,
                         int threads, Progress* progress) {
  require_valid(config, "volume");
  VolumeResult result{.map = volume::VolumeMap(config.map),
                      .report = {},
                      .counts = {},
                      .is_filtered = filter,
                      .sensor_poses = {}};
  WorkerPool pool(threads);
  volume::VoxelFilter moving(config.filter, result.map.lattice(), volume::ray_limits(config.map));
  volume::Cloud cloud;
  std::size_t total = 0;
  if (filter) {
    const auto reader = log::CloudReader::open(log);
    while (reader->next(cloud)) {
      moving.count(cloud, pool);
      report_progress(progress, "find what moves", ++total, 0);
    }
  }
  const auto reader = log::CloudReader::open(log);
  while (reader->next(cloud)) {
    std::vector<std::uint8_t> is_dynamic;
    if (filter) is_dynamic = moving.label(cloud, pool);
    result.counts += result.map.insert(cloud, is_dynamic, pool);
    result.sensor_poses.push_back(cloud.map_from_sensor);
    report_progress(progress, "build map", result.sensor_poses.size(), total);
  }
  result.report = reader->report();
  if (result.report.clouds == 0) {
    throw InputError(
        log.string(),
        "holds no cloud with a pose" +
            (result.report.first_bad.empty() ? "" : " (" + result.report.first_bad + ")"),
        "give a log whose clouds have poses");
  }
  return result;
}

SliceRange parse_slice(const std::string& text) {
  const std::size_t colon = text.find(':');
  if (colon != std::string::npos) {
    const auto from = log::parse_double(std::string_view(text).substr(0, colon));
    const auto to = log::parse_double(std::string_view(text).substr(colon + 1));
    if (from && to && *from < *to && std::isfinite(*from) && std::isfinite(*to)) {
      return {*from, *to};
    }
  }
  throw InputError("--slice " + text, "is no range of heights",
                   "give FROM:TO in metres, as 0.2:0.5");
}

nlohmann::json write_volume(const fs::path& folder, const std::string& log,
                            const VolumeResult& result, std::vector<SliceRange> slices,
                            const Cost& cost) {
  nlohmann::json summary = make_summary(log, result, cost);
  report::write_file(folder / "map.bt", result.map.binary_file());
  report::write_file(folder / "map.ot", result.map.full_file());
  if (slices.empty() && !result.sensor_poses.empty()) {
    const double height = result.sensor_poses.front().translation.z();
    slices.push_back({height - 0.2, height + 0.2});
  }
  for (std::size_t i = 0; i < slices.size(); ++i) {
    const std::string name = "slice_" + std::to_string(i + 1) + ".yaml";
    log::write_map(folder / name, volume::slice(result.map, slices[i].from_m, slices[i].to_m));
    summary["slices"].push_back(
        {{"file", name}, {"from_m", slices[i].from_m}, {"to_m", slices[i].to_m}});
  }
  report::HtmlReport page(folder, "A 3-D map of what stands still");
  page.paragraph("Made from " + log + (result.is_filtered ? ", without what moves." : "."));
  page.table(table_of(summary));
  add_pictures(page, result);
  page.write();
  report::write_file(folder / "summary.json", summary.dump(2) + "\n");
  return summary;
}

}  // namespace strata::pipeline
