// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/volume_output.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "components/log/json_text.hpp"
#include "components/log/map_file.hpp"
#include "components/log/text.hpp"
#include "core/base/error.hpp"
#include "core/volume/slice.hpp"
#include "tools/report/html_report.hpp"
#include "tools/report/volume_picture.hpp"
#include "tools/textures/glb.hpp"

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

report::VolumeView view_from_inside(const Pose3& pose) {
  report::VolumeView inside;
  inside.from_m = pose.translation;
  inside.towards_m = pose * Eigen::Vector3d::UnitX().eval();
  inside.field_of_view_rad = 0.55 * std::numbers::pi;
  return inside;
}

/// The map in one colouring from above, from two sides, and from the first pose. prefix: of names.
void add_views(report::HtmlReport& page, const VolumeResult& result, const std::string& prefix,
               const std::vector<report::ColoredCube>& below,
               const std::vector<report::ColoredCube>& all, const std::string& caption) {
  page.picture(prefix + "above",
               report::draw_cubes(below, report::view_from_above(below, kPicturePixels)),
               "the map from above, without its ceiling", caption);
  const double pi = std::numbers::pi;
  int number = 0;
  for (const double azimuth : {-0.75 * pi, 0.25 * pi}) {
    const auto view = report::view_from_outside(below, azimuth, 0.22 * pi, kPicturePixels);
    page.picture(prefix + "outside_" + std::to_string(++number), report::draw_cubes(below, view),
                 "the map obliquely from outside, without its ceiling", caption);
  }
  if (result.sensor_poses.empty()) return;
  page.picture(
      prefix + "inside", report::draw_cubes(all, view_from_inside(result.sensor_poses.front())),
      "the map as the sensor saw it from its first pose", "Seen along x of the first pose.");
}

/// What changed: green where something appeared, red where something is gone, on a grey map.
void add_changes(report::HtmlReport& page, const VolumeResult& result,
                 const std::vector<volume::VolumeChange>& changes, double cut_m) {
  std::vector<report::ColoredCube> cubes = report::occupied_cubes(result.map, cut_m);
  for (report::ColoredCube& cube : cubes) cube.color = {205, 205, 205};
  const volume::VoxelLattice& lattice = result.map.lattice();
  const double edge_m = lattice.resolution_m();
  for (const volume::VolumeChange& change : changes) {
    for (const volume::VoxelKey& key : change.voxels) {
      // A little larger, so that it covers the voxel of the map.
      report::ColoredCube cube;
      cube.corner_m = lattice.center_m(key) - Eigen::Vector3d::Constant(0.52 * edge_m);
      cube.edge_m = 1.04 * edge_m;
      cube.color = change.appeared ? report::Color{0, 140, 100} : report::Color{200, 50, 40};
      if (cube.corner_m.z() + edge_m <= cut_m) cubes.push_back(cube);
    }
  }
  const auto view = report::view_from_outside(cubes, -0.75 * std::numbers::pi,
                                              0.3 * std::numbers::pi, kPicturePixels);
  page.picture(
      "changes", report::draw_cubes(cubes, view),
      "the map in grey with what appeared in green and what is gone in red",
      "Where the short and the long level of voxels disagree: green appeared, red is gone.");
}

void add_pictures(report::HtmlReport& page, const VolumeResult& result) {
  const double cut_m = cut_height(result);
  const std::string below =
      "What lies below " + log::format_number(std::round(10.0 * cut_m) / 10.0) + " m, ";
  add_views(page, result, "", report::occupied_cubes(result.map, cut_m),
            report::occupied_cubes(result.map), below + "coloured by height.");
  if (result.colors) {
    const volume::VoxelLattice& lattice = result.map.lattice();
    add_views(page, result, "color_", report::colored_cubes(*result.colors, lattice, cut_m),
              report::colored_cubes(*result.colors, lattice),
              below + "in the colours of the pictures; grey: in none.");
  }
  if (result.mesh) {
    add_views(page, result, "textured_", textures::texel_cubes(*result.mesh, cut_m),
              textures::texel_cubes(*result.mesh, std::numeric_limits<double>::infinity()),
              below + "flat surfaces with the pictures on them; grey: on none.");
  }
  if (result.memory) add_changes(page, result, result.memory->changes(), cut_m);
}

nlohmann::json counts_json(const volume::CloudCounts& counts) {
  return {{"total", counts.points},
          {"dynamic", counts.dynamic},
          {"not_finite", counts.not_finite},
          {"beyond_range", counts.beyond_range},
          {"outside", counts.outside}};
}

nlohmann::json box_json(const volume::VoxelLattice& lattice, const volume::VolumeChange& change) {
  const double half_m = 0.5 * lattice.resolution_m();
  const Eigen::Vector3d low = lattice.center_m(change.min) - Eigen::Vector3d::Constant(half_m);
  const Eigen::Vector3d high = lattice.center_m(change.max) + Eigen::Vector3d::Constant(half_m);
  return {low.x(), low.y(), low.z(), high.x(), high.y(), high.z()};
}

nlohmann::json changes_json(const VolumeResult& result) {
  nlohmann::json list = nlohmann::json::array();
  for (const volume::VolumeChange& change : result.memory->changes()) {
    list.push_back({{"kind", change.appeared ? "appeared" : "gone"},
                    {"voxels", change.voxels.size()},
                    {"box_m", box_json(result.map.lattice(), change)}});
  }
  return list;
}

nlohmann::json colors_json(const VolumeResult& result) {
  const auto& voxels = result.colors->voxels();
  const auto seen = std::count_if(voxels.begin(), voxels.end(),
                                  [](const auto& voxel) { return voxel.is_seen(); });
  return {{"images", result.images.images},
          {"skipped",
           {{"unreadable", result.images.unreadable},
            {"without_pose", result.images.without_pose},
            {"first_bad", result.images.first_bad}}},
          {"voxels", voxels.size()},
          {"colored", seen}};
}

nlohmann::json score_json(const VolumeScore& score) {
  return {{"moving_voxels", score.moving_voxels},
          {"moving_made", score.moving_made},
          {"moving_left", score.moving_left},
          {"gone", score.gone()},
          {"static_voxels", score.static_voxels},
          {"static_lost", score.static_lost},
          {"lost", score.lost()}};
}

double ratio(std::size_t a, std::size_t b) {
  return b == 0 ? 0.0 : static_cast<double>(a) / static_cast<double>(b);
}

nlohmann::json make_summary(const std::string& log, const VolumeResult& result, const Cost& cost) {
  const volume::VolumeSize size = result.map.size();
  std::size_t occupied = 0;
  std::size_t free = 0;
  result.map.for_each_cube([&](const volume::VoxelCube& cube) {
    const auto edge = static_cast<std::size_t>(cube.edge);
    (cube.is_occupied ? occupied : free) += edge * edge * edge;
  });
  nlohmann::json summary{
      {"log", log},
      {"format", result.report.format},
      {"poses", result.pose_source},
      {"clouds", result.report.clouds},
      {"skipped",
       {{"bad_lines", result.report.bad_lines},
        {"first_bad", result.report.first_bad},
        {"unreadable_clouds", result.report.unreadable_clouds},
        {"clouds_without_pose", result.report.clouds_without_pose},
        {"points_without_pose", result.report.points_without_pose}}},
      {"points", counts_json(result.counts)},
      {"filtered", result.is_filtered},
      {"moving", result.moving},
      {"resolution_m", result.map.config().resolution_m},
      {"nodes", size.nodes},
      {"leaves", size.leaves},
      {"bytes", size.bytes},
      {"voxels", {{"occupied", occupied}, {"free", free}}},
      {"bytes_per_voxel", ratio(size.bytes, occupied + free)},
      {"cost",
       {{"wall_s", cost.wall_s}, {"cpu_s", cost.cpu_s}, {"peak_rss_mb", cost.peak_rss_mb}}}};
  if (result.score) summary["truth"] = score_json(*result.score);
  if (result.colors) summary["colors"] = colors_json(result);
  if (result.mesh) {
    summary["textures"] = {{"polygons", result.mesh->polygons.size()},
                           {"texels", result.mesh->texels},
                           {"texels_per_voxel", result.mesh->texels_per_voxel},
                           {"seen", result.mesh->seen}};
  }
  if (result.memory) {
    const volume::VoxelMemory& memory = *result.memory;
    summary["memory"] = {{"voxels", memory.known_voxels()},
                         {"bytes", memory.bytes()},
                         {"bytes_per_voxel", ratio(memory.bytes(), memory.known_voxels())},
                         {"changes", memory.changes().size()}};
  }
  return summary;
}

report::Table table_of(const nlohmann::json& summary) {
  const auto text = [&](const nlohmann::json& value) { return value.dump(); };
  report::Table table{{"what", "how much"},
                      {{"clouds", text(summary["clouds"])},
                       {"points", text(summary["points"]["total"])},
                       {"taken for moving", text(summary["points"]["dynamic"])},
                       {"voxel edge [m]", text(summary["resolution_m"])},
                       {"occupied voxels", text(summary["voxels"]["occupied"])},
                       {"free voxels", text(summary["voxels"]["free"])},
                       {"nodes of the octree", text(summary["nodes"])},
                       {"bytes", text(summary["bytes"])}},
                      "The map in numbers."};
  if (summary.contains("truth")) {
    const auto& truth = summary["truth"];
    table.rows.push_back({"voxels that people made", text(truth["moving_made"])});
    table.rows.push_back({"of these left", text(truth["moving_left"])});
    table.rows.push_back({"static voxels", text(truth["static_voxels"])});
    table.rows.push_back({"of these lost", text(truth["static_lost"])});
  }
  return table;
}

std::string color_file(const VolumeResult& result) {
  if (result.colors) return result.colors->file(result.map);
  volume::ColorMap by_height({}, result.map, {});
  by_height.color_by_height();
  return by_height.file(result.map);
}

}  // namespace

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
                            const Cost& cost, report::Drawings& drawings) {
  nlohmann::json summary = make_summary(log, result, cost);
  report::write_file(folder / "map.bt", result.map.binary_file());
  report::write_file(folder / "map.ot", result.map.full_file());
  report::write_file(folder / "map_color.ot", color_file(result));
  if (result.mesh) report::write_file(folder / "textured.glb", textures::glb_of(*result.mesh));
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
  if (result.memory) {
    report::write_file(folder / "changes.json", log::json_text(changes_json(result)));
  }
  report::HtmlReport page(folder, "A 3-D map of what stands still", &drawings);
  page.paragraph("Made from " + log + (result.is_filtered ? ", without what moves." : "."));
  page.table(table_of(summary));
  drawings.add(folder / "pictures of the map", [&] { add_pictures(page, result); });
  page.write();
  report::write_file(folder / "summary.json", log::json_text(summary));
  return summary;
}

}  // namespace strata::pipeline
