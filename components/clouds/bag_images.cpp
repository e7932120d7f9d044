// SPDX-License-Identifier: Apache-2.0
#include "components/clouds/bag_images.hpp"

#include "strata_idl/sensor_msgs.h"

#include "components/clouds/image_messages.hpp"
#include "components/convert/cdr.hpp"
#include "components/convert/geometry_messages.hpp"
#include "core/base/error.hpp"

namespace strata::clouds {
namespace {

constexpr const char* kImageType = "sensor_msgs/msg/Image";
constexpr const char* kInfoType = "sensor_msgs/msg/CameraInfo";

}  // namespace

BagImageReader::BagImageReader(const std::filesystem::path& path, const CloudReadOptions& options)
    : path_(path), poses_(path, options) {
  if (poses_.topics_of(kImageType).empty()) return;
  const auto bag = log::BagReader::open(path);
  log::BagMessage message;
  while (bag->next(message)) {
    if (bag->topics()[message.topic].type == kInfoType) take_info(message, true);
  }
  bag_ = log::BagReader::open(path);
}

void BagImageReader::take_info(const log::BagMessage& message, bool keep_old) {
  try {
    const auto info = convert::from_cdr<sensor_msgs::msg::CameraInfo>(message.data, path_.string());
    const std::string& frame = info.header().frame_id();
    if (keep_old && cameras_.count(frame) != 0) return;
    cameras_[frame] = convert::from_message(info);
  } catch (const InputError& error) {
    bad(path_.string() + ": " + error.what());
  }
}

bool BagImageReader::take_image(const log::BagMessage& message, PosedImage& image) {
  const std::string place =
      path_.string() + ": image " +
      std::to_string(report_.images + report_.unreadable + report_.without_pose + 1);
  try {
    const auto taken = convert::from_cdr<sensor_msgs::msg::Image>(message.data, place);
    const std::string& frame = taken.header().frame_id();
    image.image = convert::from_message(taken);
    image.stamp = convert::from_message(taken.header().stamp());
    const auto camera = cameras_.find(frame);
    const bool is_calibrated = camera != cameras_.end() &&
                               camera->second.width == image.image.width &&
                               camera->second.height == image.image.height;
    if (!is_calibrated) {
      throw InputError(place, "no CameraInfo of its size for frame " + frame,
                       "record camera_info too");
    }
    image.camera = camera->second;
    const auto pose = poses_.find(frame, image.stamp);
    if (!pose) {
      ++report_.without_pose;
      bad(place + ": nothing connects " + frame + " to " + poses_.map_frame() + " at its time");
      return false;
    }
    image.map_from_camera = *pose;
    ++report_.images;
    return true;
  } catch (const InputError& error) {
    ++report_.unreadable;
    bad(error.what());
    return false;
  }
}

bool BagImageReader::next(PosedImage& image) {
  log::BagMessage message;
  while (bag_ && bag_->next(message)) {
    const std::string& type = bag_->topics()[message.topic].type;
    if (type == kInfoType) take_info(message, false);
    if (type == kImageType && take_image(message, image)) return true;
  }
  return false;
}

}  // namespace strata::clouds
