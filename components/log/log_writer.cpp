// SPDX-License-Identifier: Apache-2.0
#include "components/log/log_writer.hpp"

#include <algorithm>
#include <string>

#include "strata_idl/nav_msgs.h"
#include "strata_idl/sensor_msgs.h"
#include "strata_idl/tf2_msgs.h"

#include "components/convert/cdr.hpp"
#include "components/convert/geometry_messages.hpp"
#include "components/convert/scan_messages.hpp"
#include "components/log/odometry_track.hpp"
#include "components/log/whole_folder.hpp"

namespace fs = std::filesystem;

namespace strata::log {
namespace {

void write_messages(BagWriter& bag, const LogContent& content, const LogExtras& extras) {
  const std::size_t tf_static =
      bag.add_topic({"/tf_static", "tf2_msgs/msg/TFMessage", "cdr", recorded_qos(true)});
  const std::size_t scan_topic =
      bag.add_topic({"/scan", "sensor_msgs/msg/LaserScan", "cdr", recorded_qos()});
  const bool has_odometry = !content.odometry.empty() ||
                            std::any_of(content.observations.begin(), content.observations.end(),
                                        [](const Observation& o) { return o.has_odometry; });
  const std::size_t odom =
      has_odometry ? bag.add_topic({"/odom", "nav_msgs/msg/Odometry", "cdr", recorded_qos()}) : 0;
  const std::size_t tf =
      has_odometry ? bag.add_topic({"/tf", "tf2_msgs/msg/TFMessage", "cdr", recorded_qos()}) : 0;

  std::vector<std::size_t> more;
  for (const BagTopic& topic : extras.topics) more.push_back(bag.add_topic(topic));
  auto extra = extras.messages.begin();
  const auto write_extras_until = [&](Stamp stamp) {
    for (; extra != extras.messages.end() && extra->stamp <= stamp; ++extra) {
      bag.write(more.at(extra->topic), extra->stamp, extra->data);
    }
  };

  if (content.observations.empty()) return;
  const Observation& first = content.observations.front();
  Stamp begin = first.scan.stamp;
  if (!content.odometry.empty()) begin = std::min(begin, content.odometry.front().stamp);
  tf2_msgs::msg::TFMessage mounting;
  mounting.transforms().push_back(convert::to_transform_stamped(
      begin, first.scan.robot_from_laser, content.robot_frame, content.scan_frame));
  for (const LogExtras::Mounting& other : extras.mountings) {
    mounting.transforms().push_back(convert::to_transform_stamped(
        begin, other.robot_from_frame, content.robot_frame, other.frame));
  }
  bag.write(tf_static, begin, convert::to_cdr(mounting));

  const auto write_odometry = [&](Stamp stamp, const Pose2& pose) {
    bag.write(odom, stamp,
              convert::to_cdr(
                  convert::to_odometry(stamp, pose, content.odom_frame, content.robot_frame)));
    tf2_msgs::msg::TFMessage message;
    message.transforms().push_back(
        convert::to_transform_stamped(stamp, pose, content.odom_frame, content.robot_frame));
    bag.write(tf, stamp, convert::to_cdr(message));
  };
  std::size_t next = 0;
  const auto write_odometry_before = [&](Stamp stamp) {
    for (; next < content.odometry.size() && content.odometry[next].stamp < stamp; ++next) {
      write_odometry(content.odometry[next].stamp, content.odometry[next].odom_from_robot);
    }
  };
  for (const Observation& observation : content.observations) {
    const Stamp stamp = observation.scan.stamp;
    write_odometry_before(stamp);
    if (observation.has_odometry) {
      write_odometry(stamp, observation.odom_from_robot);
      while (next < content.odometry.size() && content.odometry[next].stamp == stamp) ++next;
    }
    bag.write(scan_topic, stamp,
              convert::to_cdr(convert::to_message(observation.scan, content.scan_frame)));
    write_extras_until(stamp);
  }
  if (!extras.messages.empty()) write_extras_until(extras.messages.back().stamp);
  if (!content.odometry.empty()) {
    write_odometry_before(content.odometry.back().stamp + Duration{1});
  }
}

}  // namespace

std::string recorded_qos(bool transient_local, bool reliable) {
  return std::string("- history: 3\n  depth: 0\n  reliability: ") + (reliable ? "1" : "2") +
         "\n  durability: " + (transient_local ? "1" : "2") +
         "\n  deadline:\n    sec: 9223372036\n    nsec: 854775807\n  lifespan:\n    sec: "
         "9223372036\n    nsec: 854775807\n  liveliness: 1\n  liveliness_lease_duration:\n    "
         "sec: 9223372036\n    nsec: 854775807\n  avoid_ros_namespace_conventions: false";
}

void write_bag(const fs::path& folder, const LogContent& content, const BagOptions& format,
               const LogExtras& extras) {
  WholeFolder whole(folder);
  BagWriter bag(whole.aside(), format);
  write_messages(bag, content, extras);
  bag.close();
  whole.commit();
}

}  // namespace strata::log
