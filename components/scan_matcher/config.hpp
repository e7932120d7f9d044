// SPDX-License-Identifier: Apache-2.0
/// Parameters of strata::ScanMatcher.
#pragma once

#include <string>

#include "components/runtime/sensor_input.hpp"
#include "core/slam/slam.hpp"

namespace strata::scan_matcher {

struct ScanMatcherConfig {
  runtime::SensorInputConfig input;
  slam::SlamConfig slam;
  std::string map_frame = "map";
  std::string odometry_frame = "odom";
  bool publish_tf = true;
  std::string sensor_qos = "sensor_data";
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.group("input", c.input, "where scans and odometry come from");
    v.group("slam", c.slam, "poses, beam filter and the two grid maps");
    v.field("map_frame", c.map_frame, {.doc = "frame of all poses and maps out"});
    v.field("odometry_frame", c.odometry_frame, {.doc = "child of map_frame in /tf"});
    v.field("publish_tf", c.publish_tf,
            {.doc = "broadcast map_frame -> odometry_frame; switch off beside a localizer"});
    v.field("sensor_qos", c.sensor_qos, {.doc = "QoS profile of scan and odometry"});
  }
};

}  // namespace strata::scan_matcher
