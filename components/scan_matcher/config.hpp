// SPDX-License-Identifier: Apache-2.0
/// Parameters of strata::ScanMatcher.
#pragma once

#include <string>

#include "components/runtime/sensor_input.hpp"
#include "core/slam/keep_config.hpp"
#include "core/slam/slam.hpp"

namespace strata::scan_matcher {

/// What a scan matcher that was stopped goes on with.
struct SlamStoreConfig {
  std::string file;
  double period_s = 30.0;
  double carry_s = 10.0;
  double stddev_m = 0.3;
  double stddev_rad = 0.2;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field(
        "file", c.file,
        {.doc = "live: keep poses and sub-maps in this file while the robot maps, and go on from "
                "it when it exists; empty: in RAM only"});
    v.field("period_s", c.period_s,
            {.doc = "written this often, by the stamps of the scans, and when the component is "
                    "deactivated; what a crash may lose at most",
             .unit = "s",
             .min = 0.0});
    v.field(
        "carry_s", c.carry_s,
        {.doc = "when the first scan is at most this much younger than the newest one kept, the "
                "odometry has gone on and says how far the robot has moved; later it may have "
                "begun anew, and the robot is taken to be where it was: remove the file when "
                "it was carried elsewhere",
         .unit = "s",
         .min = 0.0});
    v.field("stddev_m", c.stddev_m,
            {.doc = "how well it then is where it was, per axis", .unit = "m", .min = 0.01});
    v.field("stddev_rad", c.stddev_rad, {.doc = "the same, heading", .unit = "rad", .min = 0.001});
  }
};

struct ScanMatcherConfig {
  runtime::SensorInputConfig input;
  slam::SlamConfig slam;
  slam::KeepConfig live{.window_scans = 2'000};
  SlamStoreConfig store;
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
    v.field("map_frame", c.map_frame, {.doc = "frame of all poses and maps out"});
    v.field("odometry_frame", c.odometry_frame, {.doc = "child of map_frame in /tf"});
    v.field("publish_tf", c.publish_tf,
            {.doc = "broadcast map_frame -> odometry_frame; switch off beside a localizer"});
    v.field("sensor_qos", c.sensor_qos, {.doc = "QoS profile of scan and odometry"});
  }
};

}  // namespace strata::scan_matcher
