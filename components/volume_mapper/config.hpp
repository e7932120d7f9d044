// SPDX-License-Identifier: Apache-2.0
/// Parameters of strata::VolumeMapper.
#pragma once

#include <string>

#include "components/runtime/common_settings.hpp"
#include "core/volume/dynamic_boxes.hpp"
#include "core/volume/volume_config.hpp"

namespace strata::volume_mapper {

struct VolumeMapperConfig {
  volume::VolumeConfig map;
  volume::DynamicBoxConfig boxes;
  bool leave_out_moving = true;
  bool wait_for_labels = false;
  std::string health_topic;
  std::string map_frame = "map";
  std::string topic = "octomap_binary";
  bool has_colors = true;
  std::string color_topic = "octomap_color";
  bool has_levels = false;
  std::string level_topic = "octomap_level";
  double level_period_s = 1.0;
  double short_clouds = 2.0;
  double mid_clouds = 10.0;
  double long_clouds = 50.0;
  std::string points_qos = "sensor_data";
  double publish_period_s = 1.0;
  int waiting_clouds = 20;
  double part_s = 0.02;
  std::string out_subfolder = "volume";
  std::string save;
  std::string store;
  double store_period_s = 30.0;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.group("map", c.map, "the octree");
    v.group("boxes", c.boxes, "boxes about what the 2-D beam filter takes for moving");
    v.field("leave_out_moving", c.leave_out_moving,
            {.doc = "points in these boxes free the space before them and enter nothing"});
    v.field("wait_for_labels", c.wait_for_labels,
            {.doc = "a cloud also waits until labeled_scan has come past its moment; for robots "
                    "that have a 2-D scanner and a beam filter"});
    v.field("health_topic", c.health_topic,
            {.doc = "strata_msgs/LocalizationHealth in, such as a localizer's localization_health: "
                    "clouds wait until it has come past their moment, and those that were measured "
                    "while it was not localized enter nothing; empty: poses are taken for true"});
    v.field("map_frame", c.map_frame, runtime::kMapFrame);
    v.field("topic", c.topic, {.doc = "octomap_msgs/Octomap out, binary, latched"});
    v.field("has_colors", c.has_colors,
            {.doc = "the map has the colours of clouds with a field rgb or rgba"});
    v.field("color_topic", c.color_topic,
            {.doc = "octomap_msgs/Octomap out, a ColorOcTree, latched; once a cloud had colours"});
    describe_levels(c, v);
    v.field("points_qos", c.points_qos,
            {.doc = "QoS profile of points: sensor_data, or lossless for clouds that must not be "
                    "dropped"});
    v.field("publish_period_s", c.publish_period_s,
            {.doc = "the map goes out at most this often, by the stamps of the clouds; 0: after "
                    "every cloud",
             .unit = "s",
             .min = 0.0});
    v.field("waiting_clouds", c.waiting_clouds,
            {.doc = "so many clouds may wait for tf; then the oldest is dropped and counted",
             .unit = "1",
             .min = 1.0,
             .max = 1000.0});
    v.field("part_s", c.part_s,
            {.doc = "clouds whose points have times are cut into parts of this, each with its own "
                    "pose and boxes; 0: they are not",
             .unit = "s",
             .min = 0.0});
    v.field(
        "out_subfolder", c.out_subfolder,
        {.doc =
             "at the end of a replay map.bt, map.ot and, with colours, map_color.ot go into this "
             "folder of its output, with levels map_short.bt, map_mid.bt and map_long.bt"});
    v.field("save", c.save,
            {.doc = "write the map to this .bt file when the component is deactivated; empty: do "
                    "not"});
    v.field("store", c.store,
            {.doc = "live: keep the map in this .ot file while the robot runs, and go on with what "
                    "it holds, colours in NAME_color.ot beside it; empty: in RAM only"});
    v.field("store_period_s", c.store_period_s,
            {.doc = "live: what a crash may lose at most; each time the whole map is written",
             .unit = "s",
             .min = 0.0,
             .max = 3600.0});
  }

 private:
  template <class Self, class V>
  static void describe_levels(Self& c, V& v) {
    v.field("has_levels", c.has_levels,
            {.doc = "also map what was there of late, for a while and for long; kept in RAM only"});
    v.field("level_topic", c.level_topic,
            {.doc = "octomap_msgs/Octomap out, binary, latched, on TOPIC/short, TOPIC/mid and "
                    "TOPIC/long"});
    v.field(
        "level_period_s", c.level_period_s,
        {.doc = "levels take a cloud at most this often, by the stamps", .unit = "s", .min = 0.0});
    v.field("short_clouds", c.short_clouds,
            {.doc = "half-life of the short level, in such clouds that saw the voxel",
             .min = 0.1,
             .max = 150.0});
    v.field("mid_clouds", c.mid_clouds, {.doc = "of the mid level", .min = 0.1, .max = 150.0});
    v.field("long_clouds", c.long_clouds, {.doc = "of the long level", .min = 0.1, .max = 150.0});
    v.require(c.short_clouds <= c.mid_clouds && c.mid_clouds <= c.long_clouds, "long_clouds",
              "is not the longest", "order them short, mid, long");
  }
};

}  // namespace strata::volume_mapper
