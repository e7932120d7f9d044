// SPDX-License-Identifier: Apache-2.0
#include "components/clouds/bag_poses.hpp"

#include <utility>

#include "strata_idl/tf2_msgs.h"

#include "components/convert/cdr.hpp"
#include "components/convert/geometry_messages.hpp"
#include "components/log/bag.hpp"
#include "core/base/error.hpp"

namespace strata::clouds {

BagPoses::BagPoses(const std::filesystem::path& path, CloudReadOptions options)
    : path_(path), options_(std::move(options)) {
  const auto bag = log::BagReader::open(path);
  log::BagMessage message;
  while (bag->next(message)) {
    const log::BagTopic& topic = bag->topics()[message.topic];
    topics_.emplace(topic.type, topic.name);
    if (topic.type != "tf2_msgs/msg/TFMessage") continue;
    add_transforms(message.data, topic.name.find("tf_static") != std::string::npos);
  }
  if (transforms_.knows("map") || options_.robot_poses) map_frame_ = "map";
}

void BagPoses::add_transforms(const std::vector<std::uint8_t>& bytes, bool is_static) {
  try {
    const auto message =
        convert::from_cdr<tf2_msgs::msg::TFMessage>(bytes, path_.string() + ": tf");
    for (const auto& transform : message.transforms()) {
      const Pose3 pose = convert::from_message(transform.transform());
      if (!pose.translation.allFinite() || !pose.rotation.coeffs().allFinite()) {
        bad_.push_back(path_.string() + ": a transform to " + transform.child_frame_id() +
                       " is not finite");
      } else if (is_static) {
        transforms_.add_fixed(transform.header().frame_id(), transform.child_frame_id(), pose);
      } else {
        transforms_.add(transform.header().frame_id(), transform.child_frame_id(),
                        convert::from_message(transform.header().stamp()), pose);
      }
    }
  } catch (const InputError& error) {
    bad_.emplace_back(error.what());
  }
}

std::optional<Pose3> BagPoses::find(const std::string& frame, Stamp stamp) const {
  if (!options_.robot_poses) return transforms_.find(map_frame_, frame, stamp);
  const auto robot = options_.robot_poses(stamp);
  const auto mounting = transforms_.find(options_.robot_frame, frame, stamp);
  if (!robot || !mounting) return std::nullopt;
  return *robot * *mounting;
}

std::set<std::string> BagPoses::topics_of(const std::string& type) const {
  std::set<std::string> names;
  for (const auto& [of, name] : topics_) {
    if (of == type) names.insert(name);
  }
  return names;
}

bool is_bag(const std::filesystem::path& path) { return log::is_bag(path); }

}  // namespace strata::clouds
