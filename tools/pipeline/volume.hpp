// SPDX-License-Identifier: Apache-2.0
/// From a 3-D log to a static 3-D map.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "components/clouds/bag_images.hpp"
#include "components/clouds/cloud_reader.hpp"
#include "core/base/progress.hpp"
#include "core/volume/color_map.hpp"
#include "core/volume/dynamic_boxes.hpp"
#include "core/volume/volume_map.hpp"
#include "core/volume/voxel_filter.hpp"
#include "core/volume/voxel_memory.hpp"
#include "tools/pipeline/volume_sources.hpp"
#include "tools/pipeline/volume_truth.hpp"
#include "tools/textures/textured_mesh.hpp"

namespace strata::pipeline {

/// Everything that can be set about 3-D maps.
struct VolumeJobConfig {
  volume::VolumeConfig map;
  MovingKind moving = MovingKind::kAuto;
  volume::VoxelFilterConfig filter;
  volume::DynamicBoxConfig boxes;
  double part_s = 0.02;
  double sweep_s = 0.0;
  bool remember = false;
  volume::VoxelMemoryConfig memory;
  volume::ColorConfig colors;
  bool has_textures = false;
  textures::TextureConfig textures;
  slam::SlamConfig slam;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.group("map", c.map, "the octree");
    v.field("moving", c.moving,
            {.doc = "how points on what moves are told: boxes about dynamic planar beams, EM on "
                    "voxels, both (either says so), none; auto: both when the log has planar "
                    "scans (boxes alone when change is remembered), else voxels"});
    v.group("filter", c.filter, "what voxels are taken for moving");
    v.group("boxes", c.boxes, "boxes about what the planar scanner saw move");
    v.field("part_s", c.part_s,
            {.doc = "clouds whose points have times are cut into parts of this, each with its own "
                    "pose and boxes; 0: they are not",
             .unit = "s",
             .min = 0.0});
    v.field("sweep_s", c.sweep_s,
            {.doc = "how long a cloud takes whose points have no times: half of it widens the "
                    "window of boxes",
             .unit = "s",
             .min = 0.0});
    v.field("remember", c.remember,
            {.doc = "keep short, mid and long levels of every voxel, and tell what changed"});
    v.group("memory", c.memory, "the levels of a voxel");
    v.group("colors", c.colors, "which picture a voxel takes its colour from");
    v.field("has_textures", c.has_textures,
            {.doc = "flat surfaces become polygons with the pictures on them (textured.glb)",
             .when = "the map is to be shown, and the log has images"});
    v.group("textures", c.textures, "polygons with pictures");
    v.group("slam", c.slam, "poses and labels from planar scans");
  }
};

struct VolumeResult {
  explicit VolumeResult(const volume::VolumeConfig& config) : map(config) {}

  volume::VolumeMap map;
  clouds::CloudReport report;
  volume::CloudCounts counts;
  bool is_filtered = false;
  std::string moving;  ///< "boxes", "voxels", "boxes and voxels", "nothing"
  std::string pose_source;
  std::vector<std::string> warnings;
  std::vector<Pose3> sensor_poses;
  std::optional<VolumeScore> score;            ///< where clouds had truth
  std::optional<volume::VoxelMemory> memory;   ///< with `remember`
  std::optional<volume::ColorMap> colors;      ///< where there were images
  std::optional<textures::TexturedMesh> mesh;  ///< ... with `has_textures`
  clouds::ImageReport images;
};

/// Reads the log once, more often with the filter on voxels (the first time to learn what moves),
/// with images, and with textures. A .bt or .ot file is a map already: it is read as such. poses: a
/// file of map_from_robot, or empty. Throws InputError, ConfigError, Cancelled.
[[nodiscard]] VolumeResult make_volume(const std::filesystem::path& log, const std::string& poses,
                                       const VolumeJobConfig& config, int threads,
                                       Progress* progress);

}  // namespace strata::pipeline
