// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/volume.hpp"

#include <fstream>
#include <sstream>
#include <utility>

#include "components/log/spooled_input.hpp"
#include "core/base/error.hpp"
#include "core/base/parallel.hpp"

namespace fs = std::filesystem;

namespace strata::pipeline {
namespace {

/// What labels the points of a cloud.
class Labels {
 public:
  Labels(const VolumeJobConfig& config, const VolumeSources& sources,
         const volume::VolumeMap& map) {
    if (sources.uses_voxels) {
      voxels_.emplace(config.filter, map.lattice(), volume::ray_limits(config.map));
    }
    if (sources.uses_boxes) {
      boxes_.emplace(config.boxes, volume::dynamic_points(sources.scans));
    }
  }
  [[nodiscard]] volume::VoxelFilter* voxels() { return voxels_ ? &*voxels_ : nullptr; }
  [[nodiscard]] std::vector<std::uint8_t> of(const volume::Cloud& cloud, WorkerPool& pool) const {
    std::vector<std::uint8_t> labels;
    if (voxels_) labels = voxels_->label(cloud, pool);
    if (boxes_) {
      const std::vector<std::uint8_t> inside = boxes_->label(cloud);
      labels.resize(inside.size(), 0);
      for (std::size_t i = 0; i < inside.size(); ++i) labels[i] |= inside[i];
    }
    return labels;
  }

 private:
  std::optional<volume::VoxelFilter> voxels_;
  std::optional<volume::DynamicBoxes> boxes_;
};

/// Nothing when the file is no map of OctoMap.
std::optional<volume::VolumeMap> read_octomap(const fs::path& path) {
  log::require_reachable(path);
  const fs::path readable = log::readable_path(path);
  if (!fs::is_regular_file(readable)) return std::nullopt;
  std::ifstream in(readable, std::ios::binary);
  std::string start(14, '\0');
  in.read(start.data(), static_cast<std::streamsize>(start.size()));
  if (start != "# Octomap OcTr") return std::nullopt;
  in.seekg(0);
  std::ostringstream bytes;
  bytes << in.rdbuf();
  return volume::VolumeMap::from_file(bytes.str(), path.string());
}

std::string name_of(const VolumeSources& sources) {
  if (sources.uses_boxes && sources.uses_voxels) return "boxes and voxels";
  if (sources.uses_boxes) return "boxes";
  return sources.uses_voxels ? "voxels" : "nothing";
}

void color(const fs::path& log, const VolumeJobConfig& config, const VolumeSources& sources,
           VolumeResult& result, WorkerPool& pool, Progress* progress) {
  clouds::BagImageReader reader(log, sources.reading);
  clouds::PosedImage image;
  while (reader.next(image)) {
    if (!result.colors) {
      result.colors.emplace(config.colors, result.map, volume::moving_witnesses(sources.scans));
    }
    result.colors->add({image.stamp, image.map_from_camera, image.camera, &image.image}, pool);
    report_progress(progress, "colour the map", reader.report().images, 0);
  }
  result.images = reader.report();
}

void warn_without_pictures(const VolumeJobConfig& config, VolumeResult& result) {
  if (!config.has_textures) return;
  result.warnings.emplace_back(
      "has_textures: the log has no pictures of a camera whose pose is "
      "known, and there is no textured.glb");
}

/// The pictures once more, in the same order.
void texture(const fs::path& log, const VolumeJobConfig& config, const VolumeSources& sources,
             VolumeResult& result, Progress* progress) {
  if (!result.colors) return warn_without_pictures(config, result);
  textures::TextureMaker maker(config.textures, *result.colors, result.map.lattice());
  if (maker.is_too_large()) {
    result.warnings.emplace_back(
        "has_textures: the map has more flat surface than a texture of textures.max_edge pixels a "
        "side holds, and there is no textured.glb; a larger map.resolution_m makes it fit");
    return;
  }
  clouds::BagImageReader reader(log, sources.reading);
  clouds::PosedImage image;
  for (std::int32_t view = 0; reader.next(image); ++view) {
    maker.add(view, {image.stamp, image.map_from_camera, image.camera, &image.image});
    report_progress(progress, "texture the map", reader.report().images, result.images.images);
  }
  result.mesh = maker.mesh();
  if (!result.mesh->polygons.empty()) return;
  result.mesh.reset();  // glTF has no empty meshes
  result.warnings.emplace_back(
      "has_textures: the map has no flat surface large enough, and there "
      "is no textured.glb");
}

void require_clouds(const fs::path& log, const clouds::CloudReport& report) {
  if (report.clouds > 0) return;
  throw InputError(log.string(),
                   "holds no cloud with a pose" +
                       (report.first_bad.empty() ? "" : " (" + report.first_bad + ")"),
                   "give a log whose clouds have poses, or --poses");
}

}  // namespace

VolumeResult make_volume(const fs::path& log, const std::string& poses,
                         const VolumeJobConfig& config, int threads, Progress* progress) {
  require_valid(config, "volume");
  VolumeResult result(config.map);
  if (auto map = read_octomap(log)) {
    result.map = std::move(*map);
    result.report.format = "OctoMap tree";
    result.pose_source = "none";
    result.moving = "nothing";
    warn_without_pictures(config, result);
    return result;
  }
  WorkerPool pool(threads);
  VolumeSources sources = find_volume_sources(log, poses, config.moving, config.remember,
                                              config.slam, threads, progress);
  sources.reading.part_s = config.part_s;
  result.is_filtered = sources.uses_boxes || sources.uses_voxels;
  result.moving = name_of(sources);
  result.pose_source = sources.pose_source;
  result.warnings = sources.warnings;
  Labels labels(config, sources, result.map);
  VolumeTruth truth(config.map);
  if (config.remember) {
    result.memory.emplace(config.memory, result.map.lattice(), volume::ray_limits(config.map));
  }
  volume::Cloud cloud;
  std::size_t total = 0;
  if (volume::VoxelFilter* moving = labels.voxels()) {
    const auto reader = clouds::CloudReader::open(log, sources.reading);
    while (reader->next(cloud)) {
      moving->count(cloud, pool);
      report_progress(progress, "find what moves", ++total, 0);
    }
  }
  const auto reader = clouds::CloudReader::open(log, sources.reading);
  while (reader->next(cloud)) {
    cloud.sweep_s = config.sweep_s;
    const std::vector<std::uint8_t> is_dynamic = labels.of(cloud, pool);
    result.counts += result.map.insert(cloud, is_dynamic, pool);
    if (result.memory) result.memory->observe(cloud, is_dynamic, pool);
    truth.add(cloud, pool);
    result.sensor_poses.push_back(cloud.map_from_sensor);
    report_progress(progress, "build map", result.sensor_poses.size(), total);
  }
  result.report = reader->report();
  require_clouds(log, result.report);
  result.score = truth.score(result.map);
  if (clouds::is_bag(log)) color(log, config, sources, result, pool, progress);
  if (config.has_textures) texture(log, config, sources, result, progress);
  return result;
}

}  // namespace strata::pipeline
