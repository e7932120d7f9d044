// SPDX-License-Identifier: Apache-2.0
/// A robot's messages, as a log and as they came.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "components/bus/message_types.hpp"
#include "components/convert/cdr.hpp"
#include "components/convert/geometry_messages.hpp"
#include "components/log/bag.hpp"
#include "components/log/log_reader.hpp"
#include "components/runtime/sensor_input.hpp"
#include "tests/support/same_scan.hpp"
#include "tests/support/test_data.hpp"

namespace strata::test {

inline Stamp at(double seconds) { return Stamp{} + Duration::from_seconds(seconds); }

inline tf2_msgs::msg::TFMessage link(double seconds, const std::string& parent,
                                     const std::string& child, const Pose2& pose) {
  tf2_msgs::msg::TFMessage message;
  message.transforms().push_back(convert::to_transform_stamped(at(seconds), pose, parent, child));
  return message;
}

/// The same, rolled over about its x axis.
inline tf2_msgs::msg::TFMessage rolled_link(const std::string& parent, const std::string& child,
                                            double x_m, double y_m) {
  tf2_msgs::msg::TFMessage message = link(0.0, parent, child, {x_m, y_m, 0.0});
  message.transforms()[0].transform().rotation().w(0.0);
  message.transforms()[0].transform().rotation().x(1.0);
  return message;
}

inline nav_msgs::msg::Odometry odometry(double seconds, const Pose2& pose,
                                        const std::string& child = "base_link") {
  nav_msgs::msg::Odometry message;
  message.header(convert::make_header(at(seconds), "odom"));
  message.child_frame_id(child);
  message.pose().pose(convert::to_pose(pose));
  return message;
}

inline sensor_msgs::msg::LaserScan no_beams(double seconds, const std::string& frame,
                                            float angle_increment_rad) {
  sensor_msgs::msg::LaserScan message;
  message.header(convert::make_header(at(seconds), frame));
  message.angle_min(-1.0F);
  message.angle_increment(angle_increment_rad);
  message.range_max(10.0F);
  return message;
}

/// Three beams at once.
inline sensor_msgs::msg::LaserScan scan(double seconds, const std::string& frame = "laser") {
  sensor_msgs::msg::LaserScan message = no_beams(seconds, frame, 1.0F);
  message.angle_max(1.0F);
  message.ranges({1.0F, 2.0F, 3.0F});
  return message;
}

/// A wall ahead, lopsided, with time between the beams.
inline sensor_msgs::msg::LaserScan sweep(double seconds, const std::string& frame = "laser") {
  sensor_msgs::msg::LaserScan message = no_beams(seconds, frame, 0.05F);
  message.time_increment(0.001F);
  message.range_min(0.1F);
  for (int i = 0; i < 41; ++i) {
    message.ranges().push_back(2.0F + 0.03F * static_cast<float>(i) +
                               0.1F * static_cast<float>(seconds));
  }
  return message;
}

/// Where it is when it drives a bend.
inline Pose2 on_a_bend(double seconds) {
  return {0.5 * seconds, 0.1 * seconds * seconds, 0.4 * seconds};
}

class RecordedRobot {
 public:
  /// received_s: when the recorder, or the component, gets it.
  template <typename T>
  void say(double received_s, const std::string& topic, const T& message) {
    messages_.push_back({topic, bus::MessageType<T>::name, at(received_s), convert::to_cdr(message),
                         give(topic, message)});
  }

  [[nodiscard]] std::vector<Observation> by_the_log(const log::ReadOptions& options = {}) const {
    const TemporaryDirectory folder;
    log::BagWriter writer(folder.path() / "bag", log::BagStorage::kMcap);
    for (const Message& message : in_order()) {
      writer.write(writer.add_topic({message.topic, message.type}), message.received, message.data);
    }
    writer.close();
    return log::read_observations(folder.path() / "bag", options, &report);
  }

  [[nodiscard]] std::vector<Observation> live(runtime::SensorInputConfig config = {}) const {
    if (config.scan_topics.empty() && config.scan_topic == "scan") config.scan_topic = "/scan";
    runtime::SensorInput input(config, true);
    std::vector<Observation> taken;
    for (const Message& message : in_order()) {
      message.give(input, config);
      for (Observation& observation : input.take()) {
        input.watch_clock(observation);
        taken.push_back(std::move(observation));
      }
    }
    warnings = input.take_warnings();
    return taken;
  }

  mutable log::ReadReport report;             ///< of by_the_log
  mutable std::vector<std::string> warnings;  ///< of live

 private:
  using Give =
      std::function<void(runtime::SensorInput& input, const runtime::SensorInputConfig& config)>;
  struct Message {
    std::string topic;
    std::string type;
    Stamp received;
    std::vector<std::uint8_t> data;
    Give give;
  };

  template <typename T>
  static Give give(const std::string& topic, const T& message) {
    return [topic, message](runtime::SensorInput& input, const runtime::SensorInputConfig& config) {
      if constexpr (std::is_same_v<T, tf2_msgs::msg::TFMessage>) {
        topic == "/tf" ? input.add_moving(message) : input.add(message);
      } else if constexpr (std::is_same_v<T, nav_msgs::msg::Odometry>) {
        input.add(message);
      } else {
        const std::vector<std::string> topics = config.all_scan_topics();
        const auto place = std::find(topics.begin(), topics.end(), topic);
        if (place == topics.end()) return;
        input.add(message, static_cast<std::size_t>(place - topics.begin()));
      }
    };
  }

  [[nodiscard]] std::vector<Message> in_order() const {
    std::vector<Message> sorted = messages_;
    std::stable_sort(sorted.begin(), sorted.end(),
                     [](const Message& a, const Message& b) { return a.received < b.received; });
    return sorted;
  }

  std::vector<Message> messages_;
};

inline void expect_same_bits(const std::vector<Observation>& a, const std::vector<Observation>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    SCOPED_TRACE("observation " + std::to_string(i));
    expect_same_scan(a[i].scan, b[i].scan);
    EXPECT_EQ(a[i].has_odometry, b[i].has_odometry);
    EXPECT_EQ(a[i].odom_from_robot, b[i].odom_from_robot);
  }
}

}  // namespace strata::test
