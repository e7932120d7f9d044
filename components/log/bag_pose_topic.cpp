// SPDX-License-Identifier: Apache-2.0
#include "components/log/bag_pose_topic.hpp"

#include <optional>
#include <string>

#include "strata_idl/geometry_msgs.h"
#include "strata_idl/nav_msgs.h"

#include "components/convert/cdr.hpp"
#include "components/convert/geometry_messages.hpp"
#include "components/log/bag.hpp"
#include "components/log/robot_frames.hpp"
#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::log {
namespace {

constexpr const char* kPoseType = "geometry_msgs/msg/PoseStamped";
constexpr const char* kUsualTopic = "/ground_truth";

struct BagAndTopic {
  fs::path bag;
  std::string topic;  ///< empty: not named
};

BagAndTopic parts_of(const fs::path& path) {
  const std::string text = path.string();
  const std::size_t colon = text.rfind(":/");
  std::error_code ignored;
  if (fs::exists(path, ignored) || colon == std::string::npos) return {path, ""};
  return {text.substr(0, colon), text.substr(colon + 1)};
}

std::optional<SpacePose> decode(const BagTopic& topic, const BagMessage& message) {
  const auto posed = [](const auto& header, const auto& pose) {
    return SpacePose{convert::from_message(header.stamp()), convert::from_message(pose)};
  };
  if (topic.type == kPoseType) {
    const auto read = convert::from_cdr<geometry_msgs::msg::PoseStamped>(message.data, topic.name);
    return posed(read.header(), read.pose());
  }
  if (topic.type == "geometry_msgs/msg/PoseWithCovarianceStamped") {
    const auto read =
        convert::from_cdr<geometry_msgs::msg::PoseWithCovarianceStamped>(message.data, topic.name);
    return posed(read.header(), read.pose().pose());
  }
  if (topic.type == "nav_msgs/msg/Odometry") {
    const auto read = convert::from_cdr<nav_msgs::msg::Odometry>(message.data, topic.name);
    return posed(read.header(), read.pose().pose());
  }
  return std::nullopt;
}

std::string choose(const fs::path& bag, const std::vector<BagTopic>& topics) {
  std::vector<std::string> names;
  for (const BagTopic& topic : topics) {
    if (topic.type == kPoseType) names.push_back(topic.name);
  }
  for (const std::string& name : names) {
    if (name == kUsualTopic) return name;
  }
  if (names.size() == 1) return names.front();
  throw InputError(bag.string(),
                   names.empty() ? "holds no topic of geometry_msgs/PoseStamped"
                                 : "holds " + std::to_string(names.size()) + " topics of poses",
                   "name the topic of the poses: " + bag.string() +
                       (names.empty() ? ":/odom" : ":" + names.front()));
}

}  // namespace

bool names_pose_topic(const fs::path& path) {
  const fs::path bag = parts_of(path).bag;
  std::error_code ignored;
  return fs::exists(bag, ignored) && is_bag(bag);
}

PoseTopic read_pose_topic(const fs::path& path) {
  const auto [bag, named] = parts_of(path);
  const auto reader = BagReader::open(bag);
  PoseTopic result;
  // A bag without its index may tell of its topics only while it is read.
  std::string wanted = named;
  BagMessage message;
  while (reader->next(message)) {
    if (wanted.empty()) wanted = choose(bag, reader->topics());
    const BagTopic& topic = reader->topics()[message.topic];
    if (topic.name != wanted) continue;
    try {
      const auto pose = decode(topic, message);
      if (!pose) {
        throw InputError(bag.string() + ":" + wanted, "has no poses, but " + topic.type,
                         "see `strata info` for its topics");
      }
      if (is_sound(pose->pose)) {
        result.poses.push_back(
            {pose->stamp, {pose->pose.translation, pose->pose.rotation.normalized()}});
      } else {
        ++result.unreadable;
      }
    } catch (const convert::Undecodable&) {
      ++result.unreadable;
    }
  }
  result.unreadable += reader->damage().count;
  if (result.poses.empty()) {
    throw InputError(bag.string(),
                     "holds no readable pose" + (wanted.empty() ? "" : " on " + wanted),
                     "see `strata info` for its topics");
  }
  return result;
}

}  // namespace strata::log
