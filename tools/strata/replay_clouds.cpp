// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/replay_clouds.hpp"

#include <utility>

#include "strata_idl/nav_msgs.h"

#include "components/clouds/bag_poses.hpp"
#include "components/convert/cdr.hpp"
#include "components/convert/geometry_messages.hpp"
#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

constexpr const char* kRobot = "base_link";

}  // namespace

std::unique_ptr<ReplayClouds> ReplayClouds::open(const fs::path& path, Outputs outputs) {
  if (!clouds::is_bag(path)) return nullptr;
  const auto topics = clouds::BagPoses(path, {}).topics_of("sensor_msgs/msg/PointCloud2");
  if (topics.empty()) return nullptr;
  return std::unique_ptr<ReplayClouds>(new ReplayClouds(path, *topics.begin(), std::move(outputs)));
}

ReplayClouds::ReplayClouds(const fs::path& path, std::string topic, Outputs outputs)
    : path_(path),
      topic_(std::move(topic)),
      outputs_(std::move(outputs)),
      bag_(log::BagReader::open(path)) {
  read_next();
}

tf2_msgs::msg::TFMessage ReplayClouds::mountings() const {
  tf2_msgs::msg::TFMessage all;
  std::string robot;
  const auto bag = log::BagReader::open(path_);
  log::BagMessage message;
  while (bag->next(message)) {
    const log::BagTopic& topic = bag->topics()[message.topic];
    try {
      if (robot.empty() && topic.type == "nav_msgs/msg/Odometry") {
        robot =
            convert::from_cdr<nav_msgs::msg::Odometry>(message.data, topic.name).child_frame_id();
      } else if (topic.name == "/tf_static") {
        const auto some = convert::from_cdr<tf2_msgs::msg::TFMessage>(message.data, topic.name);
        for (const auto& transform : some.transforms()) all.transforms().push_back(transform);
      }
    } catch (const InputError&) {
      // Who reads the log's scans says so.
    }
  }
  for (auto& transform : all.transforms()) {
    if (robot.empty()) break;
    if (transform.header().frame_id() == robot) transform.header().frame_id(kRobot);
    if (transform.child_frame_id() == robot) transform.child_frame_id(kRobot);
  }
  return all;
}

void ReplayClouds::publish_until(Stamp stamp) {
  if (!std::exchange(has_begun_, true)) outputs_.tf_static(mountings());
  while (next_ && convert::from_message(next_->header().stamp()) <= stamp) {
    outputs_.points(*next_);
    read_next();
  }
}

void ReplayClouds::read_next() {
  next_.reset();
  log::BagMessage message;
  while (!next_ && bag_->next(message)) {
    if (bag_->topics()[message.topic].name != topic_) continue;
    try {
      next_ = convert::from_cdr<sensor_msgs::msg::PointCloud2>(message.data, topic_);
    } catch (const InputError&) {
      continue;
    }
  }
}

}  // namespace strata::tools
