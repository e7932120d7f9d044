// SPDX-License-Identifier: Apache-2.0
#include "components/log/bag_clouds.hpp"

#include <set>
#include <string>

#include "strata_idl/sensor_msgs.h"
#include "strata_idl/tf2_msgs.h"

#include "components/convert/cdr.hpp"
#include "components/convert/cloud_messages.hpp"
#include "components/convert/geometry_messages.hpp"
#include "components/log/bag.hpp"
#include "components/log/transform_history.hpp"
#include "core/base/error.hpp"

namespace strata::log {
namespace {

class BagCloudReader final : public CloudReader {
 public:
  explicit BagCloudReader(const std::filesystem::path& path) : path_(path) {
    read_transforms();
    map_frame_ = transforms_.knows("map") ? "map" : "odom";
    bag_ = BagReader::open(path);
    report_.format = "rosbag2, " + bag_->description();
  }

  bool next(volume::Cloud& cloud) override {
    BagMessage message;
    while (bag_->next(message)) {
      if (bag_->topics()[message.topic].name != topic_) continue;
      const std::string place =
          path_.string() + ": " + topic_ + " message " + std::to_string(++messages_);
      try {
        if (take(convert::from_cdr<sensor_msgs::msg::PointCloud2>(message.data, place), place,
                 cloud)) {
          ++report_.clouds;
          return true;
        }
      } catch (const InputError& error) {
        bad(place + ": " + error.what());
      }
    }
    for (; damage_told_ < bag_->damage().count; ++damage_told_) bad(bag_->damage().first);
    return false;
  }

 private:
  void read_transforms() {
    const auto bag = BagReader::open(path_);
    std::set<std::string> cloud_topics;
    BagMessage message;
    while (bag->next(message)) {
      const BagTopic& topic = bag->topics()[message.topic];
      if (topic.type == "sensor_msgs/msg/PointCloud2") cloud_topics.insert(topic.name);
      if (topic.type != "tf2_msgs/msg/TFMessage") continue;
      try {
        add_transforms(
            convert::from_cdr<tf2_msgs::msg::TFMessage>(message.data, path_.string() + ": tf"),
            topic.name.find("tf_static") != std::string::npos);
      } catch (const InputError& error) {
        bad(error.what());
      }
    }
    if (cloud_topics.empty()) {
      throw InputError(path_.string(), "no sensor_msgs/msg/PointCloud2 can be read",
                       "see `strata info` for its topics");
    }
    topic_ = *cloud_topics.begin();
  }

  void add_transforms(const tf2_msgs::msg::TFMessage& message, bool is_static) {
    for (const auto& transform : message.transforms()) {
      const Pose3 pose = convert::from_message(transform.transform());
      if (!pose.translation.allFinite() || !pose.rotation.coeffs().allFinite()) {
        bad(path_.string() + ": a transform to " + transform.child_frame_id() + " is not finite");
      } else if (is_static) {
        transforms_.add_fixed(transform.header().frame_id(), transform.child_frame_id(), pose);
      } else {
        transforms_.add(transform.header().frame_id(), transform.child_frame_id(),
                        convert::from_message(transform.header().stamp()), pose);
      }
    }
  }

  bool take(const sensor_msgs::msg::PointCloud2& message, const std::string& place,
            volume::Cloud& cloud) {
    cloud.points_m = convert::from_message(message);
    cloud.stamp = convert::from_message(message.header().stamp());
    const auto pose = transforms_.find(map_frame_, message.header().frame_id(), cloud.stamp);
    if (!pose) {
      ++report_.clouds_without_pose;
      report_.points_without_pose += cloud.points_m.size();
      bad(place + ": tf does not tie " + message.header().frame_id() + " to " + map_frame_ +
          " at its time");
      return false;
    }
    cloud.map_from_sensor = *pose;
    return true;
  }

  std::filesystem::path path_;
  TransformHistory transforms_;
  std::string map_frame_;
  std::string topic_;
  std::unique_ptr<BagReader> bag_;
  std::size_t messages_ = 0;
  std::size_t damage_told_ = 0;
};

}  // namespace

std::unique_ptr<CloudReader> open_bag_clouds(const std::filesystem::path& path) {
  return std::make_unique<BagCloudReader>(path);
}

}  // namespace strata::log
