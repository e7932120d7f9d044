// SPDX-License-Identifier: Apache-2.0
/// Parameters of strata::TopologyMapper.
#pragma once

#include <string>
#include <vector>

#include "components/runtime/resume.hpp"
#include "components/runtime/sensor_input.hpp"
#include "core/topology/mapper_config.hpp"

namespace strata::topology_mapper {

/// What a topology mapper that was stopped goes on with.
struct MapperStoreConfig {
  std::string file;
  double save_period_s = 1.0;
  runtime::DeadReckoningConfig dead_reckoning;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("file", c.file,
            {.doc = "live: keep the scans and their poses in this file, and go on from it when it "
                    "exists; about a byte a beam; empty: in RAM only",
             .when = "mapping shall go on after a restart"});
    v.field("save_period_s", c.save_period_s,
            {.doc = "what a crash may lose at most", .unit = "s", .min = 0.0, .max = 60.0});
    runtime::DeadReckoningConfig::describe(c.dead_reckoning, v);
  }
};

struct TopologyMapperComponentConfig {
  runtime::SensorInputConfig input;
  topology::TopologyMapperConfig mapping;
  std::vector<double> landmark_times_s;
  std::string landmark_topic = "landmark";
  std::string map_frame = "map";
  std::string topic = "topologies";
  int published_topologies = 10;
  std::string sensor_qos = "sensor_data";
  std::string out_subfolder = "topology";
  std::string save;
  topology::PathKeepConfig keep{.subsample_m = 0.05, .subsample_rad = 0.05, .memory_mb = 512.0};
  MapperStoreConfig store;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.group("input", c.input, "where scans and odometry come from");
    v.group("mapping", c.mapping, "landmarks, topologies and the metric map");
    v.field("landmark_times_s", c.landmark_times_s,
            {.doc = "the robot was at a landmark so long after the first scan; beside those that "
                    "are found, or alone with mapping.landmarks.source: given",
             .unit = "s"});
    v.field("landmark_topic", c.landmark_topic,
            {.doc = "geometry_msgs/PointStamped in: the robot is at a landmark at that stamp (0: "
                    "now); the point itself is not looked at"});
    v.field("map_frame", c.map_frame,
            {.doc = "frame of the landmarks: that of the odometry when the first scan came"});
    v.field("topic", c.topic, {.doc = "strata_msgs/Topologies out, latched, after each landmark"});
    v.field("published_topologies", c.published_topologies,
            {.doc = "the most probable ones that are published, at most", .min = 1});
    v.field("sensor_qos", c.sensor_qos, {.doc = "QoS profile of scan and odometry"});
    v.field("out_subfolder", c.out_subfolder,
            {.doc = "at the end of a replay files go into this folder of its output"});
    v.field("save", c.save,
            {.doc = "live: write the same files into this folder, which must be new, when the "
                    "component is deactivated; empty: do not"});
    v.group("keep", c.keep, "live: which scans are kept; of a log all are");
    v.group("store", c.store, "going on after the process was stopped");
  }
};

}  // namespace strata::topology_mapper
