// SPDX-License-Identifier: Apache-2.0
#include "components/clouds/bag_clouds.hpp"

#include <string>
#include <utility>

#include "strata_idl/sensor_msgs.h"

#include "components/convert/cdr.hpp"
#include "components/convert/cloud_messages.hpp"
#include "components/convert/geometry_messages.hpp"
#include "components/log/bag.hpp"
#include "core/base/error.hpp"

namespace strata::clouds {
namespace {

class BagCloudReader final : public CloudReader {
 public:
  BagCloudReader(const std::filesystem::path& path, const CloudReadOptions& options)
      : path_(path), part_s_(options.part_s), poses_(path, options), topic_(options.points_topic) {
    const auto topics = poses_.topics_of("sensor_msgs/msg/PointCloud2");
    if (topics.empty() || (!topic_.empty() && topics.count(topic_) == 0)) {
      throw InputError(path_.string(),
                       "no sensor_msgs/msg/PointCloud2 can be read" +
                           (topic_.empty() ? std::string() : " on " + topic_),
                       "see `strata info` for its topics");
    }
    if (topic_.empty()) topic_ = *topics.begin();
    for (const std::string& place_and_reason : poses_.bad()) bad(place_and_reason);
    bag_ = log::BagReader::open(path);
    report_.format = "rosbag2, " + bag_->description();
  }

  bool next(volume::Cloud& cloud) override {
    log::BagMessage message;
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
        ++report_.unreadable_clouds;
        bad(place + ": " + error.what());
      }
    }
    for (; damage_told_ < bag_->damage().count; ++damage_told_) bad(bag_->damage().first);
    return false;
  }

 private:
  bool take(const sensor_msgs::msg::PointCloud2& message, const std::string& place,
            volume::Cloud& cloud) {
    cloud = {};
    cloud.points_m = convert::from_message(message);
    cloud.stamp = convert::from_message(message.header().stamp());
    convert::CloudColumns columns = convert::columns_of(message);
    cloud.truly_moving = std::move(columns.truly_moving);
    const std::string& frame = message.header().frame_id();
    const std::size_t count = cloud.points_m.size();
    const bool is_timed = part_s_ > 0.0 && count > 0 && columns.offset_s.size() == count;
    if (is_timed) {
      report_.points_without_pose += volume::cut_by_time(
          cloud, columns.offset_s, part_s_, [&](Stamp stamp) { return poses_.find(frame, stamp); });
      if (!cloud.parts.empty()) return true;
    } else if (const auto pose = poses_.find(frame, cloud.stamp)) {
      cloud.map_from_sensor = *pose;
      return true;
    } else {
      report_.points_without_pose += count;
    }
    ++report_.clouds_without_pose;
    bad(place + ": nothing connects " + frame + " to " + poses_.map_frame() + " at its time");
    return false;
  }

  std::filesystem::path path_;
  double part_s_;
  BagPoses poses_;
  std::string topic_;
  std::unique_ptr<log::BagReader> bag_;
  std::size_t messages_ = 0;
  std::size_t damage_told_ = 0;
};

}  // namespace

std::unique_ptr<CloudReader> open_bag_clouds(const std::filesystem::path& path,
                                             const CloudReadOptions& options) {
  return std::make_unique<BagCloudReader>(path, options);
}

}  // namespace strata::clouds
