// SPDX-License-Identifier: Apache-2.0
/// Where a component's scans and odometry come from.
#pragma once

#include <string>
#include <vector>

#include "core/base/config.hpp"
#include "core/scan/cloud_slice.hpp"

namespace strata::runtime {

struct SensorInputConfig {
  std::string scan_topic = "scan";
  std::vector<std::string> scan_topics;
  std::vector<std::string> cloud_topics;
  CloudSliceConfig cloud;
  std::string odometry_topic = "odom";
  std::string tf_odometry_frame = "odom";
  std::string robot_frame = "base_link";
  bool use_odometry = true;
  double max_odometry_gap_s = 1.0;
  double odometry_lag_s = 0.0;
  bool correct_odometry_lag = true;
  double max_range_m = 0.0;
  int max_waiting_scans = 20;
  double first_wait_s = 5.0;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field(
        "scan_topic", c.scan_topic,
        {.doc = "sensor_msgs/LaserScan in", .when = "your scanner publishes under another name"});
    v.field("scan_topics", c.scan_topics,
            {.doc = "several scanners, each with its frame, rate and mounting, in place of "
                    "scan_topic",
             .when = "the robot has several planar scanners"});
    v.field("cloud_topics", c.cloud_topics,
            {.doc = "sensor_msgs/PointCloud2 in: slices of them are taken for scans, with those of "
                    "scan_topics, or in place of scan_topic",
             .when = "the robot has a 3-D scanner or a depth camera"});
    v.group("cloud", c.cloud, "which points of a cloud a scan is made of");
    v.field(
        "odometry_topic", c.odometry_topic,
        {.doc = "nav_msgs/Odometry in",
         .when =
             "your odometry has another name, or a filter such as robot_localization makes it"});
    v.field("tf_odometry_frame", c.tf_odometry_frame,
            {.doc = "live, while nobody publishes odometry_topic: odometry is this frame to "
                    "robot_frame on /tf; empty: never"});
    v.field("robot_frame", c.robot_frame,
            {.doc = "frame that poses are of; odometry of another frame that tf connects to it is "
                    "carried over",
             .when = "your robot's frame has another name"});
    v.field(
        "use_odometry", c.use_odometry,
        {.doc = "false: scans only", .when = "the robot has no odometry, or one that misleads"});
    v.field("max_odometry_gap_s", c.max_odometry_gap_s,
            {.doc = "a scan further than this from any odometry is passed over, as the log "
                    "readers do it",
             .unit = "s",
             .min = 0.0});
    v.field(
        "odometry_lag_s", c.odometry_lag_s,
        {.doc = "how much later than a scan odometry of the same moment is stamped; it is taken "
                "off odometry's stamps",
         .unit = "s",
         .min = -10.0,
         .max = 10.0,
         .when = "`strata info` of a recording, or this component's diagnostics, tell of one"});
    v.field(
        "correct_odometry_lag", c.correct_odometry_lag,
        {.doc = "live: another lag that turns of the robot show twice is taken off instead, and "
                "told; false: told only"});
    v.field("max_range_m", c.max_range_m,
            {.doc = "live: readings of scans from here on say that nothing came back, whatever "
                    "range_max is; 0: from range_max on. For scanners that send a number of their "
                    "own then, and a larger range_max; `strata info` of a recording finds it",
             .unit = "m",
             .min = 0.0,
             .max = 1000.0});
    v.renamed("most_waiting_scans", "max_waiting_scans");
    v.field("max_waiting_scans", c.max_waiting_scans,
            {.doc = "a scan waits for odometry, mounting and older scans of other scanners until "
                    "so many of each scanner have come after it",
             .unit = "scans",
             .min = 0.0});
    v.field("first_wait_s", c.first_wait_s,
            {.doc = "odometry and mountings that nobody has published yet are waited for at least "
                    "this long by the scans' stamps, or until ten times max_waiting_scans wait: "
                    "at a start scans may be heard before the rest is. Odometry that stops for as "
                    "long is waited for no more until it comes again",
             .unit = "s",
             .min = 0.0});
  }

  /// Topics with LaserScan.
  [[nodiscard]] std::vector<std::string> laser_topics() const {
    return scan_topics.empty() && cloud_topics.empty() ? std::vector{scan_topic} : scan_topics;
  }
  /// Those, and then those with clouds.
  [[nodiscard]] std::vector<std::string> all_scan_topics() const {
    std::vector<std::string> topics = laser_topics();
    topics.insert(topics.end(), cloud_topics.begin(), cloud_topics.end());
    return topics;
  }
};

}  // namespace strata::runtime
