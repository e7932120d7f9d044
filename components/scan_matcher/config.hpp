// SPDX-License-Identifier: Apache-2.0
/// Parameters of strata::ScanMatcher.
#pragma once

#include <string>

#include "components/log/state_store.hpp"
#include "components/runtime/common_settings.hpp"
#include "components/runtime/resume.hpp"
#include "components/runtime/sensor_input.hpp"
#include "core/patch/patch_learner_config.hpp"
#include "core/slam/keep_config.hpp"
#include "core/slam/slam.hpp"

namespace strata::scan_matcher {

/// What a scan matcher that was stopped goes on with.
struct SlamStoreConfig {
  log::StateStoreConfig state;
  runtime::DeadReckoningConfig dead_reckoning;
  double stddev_m = 0.3;
  double stddev_rad = 0.2;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    log::StateStoreConfig::describe(c.state, v);
    runtime::DeadReckoningConfig::describe(c.dead_reckoning, v);
    v.field("stddev_m", c.stddev_m,
            {.doc = "how well a robot that is not dead reckoned is where it was, per axis",
             .unit = "m",
             .min = 0.01});
    v.field("stddev_rad", c.stddev_rad, {.doc = "the same, heading", .unit = "rad", .min = 0.001});
  }
};

/// What others get of the map while the robot is mapping.
struct LiveMapsConfig {
  double publish_every_s = 2.0;
  std::string folder;
  double save_every_s = 60.0;
  std::string patch_topic = "patch_map";
  patch::PatchLearnerConfig patch;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("publish_every_s", c.publish_every_s,
            {.doc = "live: map, map_filtered, reflection_filtered and trajectory go out this often "
                    "as the map grows, or as seldom as keeps it to a twentieth of the time; 0: "
                    "never",
             .unit = "s",
             .min = 0.0,
             .when = "maps are needed more often, or the network is slow"});
    v.field("folder", c.folder,
            {.doc = "live: a MAPS folder, as `strata learn` writes it, is kept here, replaced as a "
                    "whole by ~/save, when the component is deactivated and every save_every_s; "
                    "empty: none",
             .when = "the robot shall keep its maps for a localizer without strata learn"});
    v.field("save_every_s", c.save_every_s,
            {.doc = "the folder is written this often while the map grows, or as seldom as keeps "
                    "it to a twentieth of the time; 0: only when asked, and at the end",
             .unit = "s",
             .min = 0.0});
    v.field("patch_topic", c.patch_topic,
            {.doc = "strata_msgs/PatchMap in: where one comes, the folder has patches too"});
    v.group("patch", c.patch,
            "how the patches of the folder are learned again at the poses that saving finds; "
            "give the patch learner and the scan matcher the same");
  }
};

struct ScanMatcherConfig {
  runtime::SensorInputConfig input;
  slam::SlamConfig slam;
  slam::KeepConfig live{.window_scans = 2'000};
  SlamStoreConfig store;
  LiveMapsConfig maps;
  std::string map_frame = "map";
  std::string odometry_frame = "odom";
  bool publish_tf = true;
  std::string sensor_qos = "sensor_data";
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.group("input", c.input, "where scans and odometry come from");
    v.group("slam", c.slam, "poses, beam filter and the two grid maps");
    v.group("live", c.live,
            "what a running robot keeps of its past; in lockstep everything is kept until the end");
    v.group("store", c.store, "going on after the process was stopped");
    v.group("maps", c.maps, "maps for others while the robot is mapping");
    v.field("map_frame", c.map_frame, runtime::kMapFrame);
    v.field("odometry_frame", c.odometry_frame, runtime::kOdometryFrame);
    v.field("publish_tf", c.publish_tf, runtime::kPublishTf);
    v.field("sensor_qos", c.sensor_qos, {.doc = "QoS profile of scan and odometry"});
  }
};

}  // namespace strata::scan_matcher
