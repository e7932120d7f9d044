// SPDX-License-Identifier: Apache-2.0
/// Pictures of a rosbag2 bag with calibration and pose.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "components/clouds/bag_poses.hpp"
#include "components/log/bag.hpp"
#include "core/volume/camera.hpp"

namespace strata::clouds {

struct PosedImage {
  Stamp stamp;
  Pose3 map_from_camera;  ///< of the optical frame
  volume::Camera camera;
  volume::ColorImage image;
};

struct ImageReport {
  std::size_t images = 0;
  std::size_t unreadable = 0;    ///< damaged, of an unknown encoding, without calibration
  std::size_t without_pose = 0;  ///< skipped
  std::string first_bad;
};

/// The pictures of every sensor_msgs/Image topic, in the order of the bag. The calibration of a
/// picture is the last sensor_msgs/CameraInfo of its frame, or the bag's first one of it.
class BagImageReader {
 public:
  /// Throws InputError when the bag cannot be read.
  BagImageReader(const std::filesystem::path& path, const CloudReadOptions& options);

  /// The next picture; false at the end. What cannot be used is skipped and counted.
  bool next(PosedImage& image);
  [[nodiscard]] const ImageReport& report() const { return report_; }

 private:
  void take_info(const log::BagMessage& message, bool keep_old);
  bool take_image(const log::BagMessage& message, PosedImage& image);
  void bad(const std::string& place_and_reason) {
    if (report_.first_bad.empty()) report_.first_bad = place_and_reason;
  }

  std::filesystem::path path_;
  BagPoses poses_;
  std::map<std::string, volume::Camera> cameras_;  ///< by frame
  std::unique_ptr<log::BagReader> bag_;
  ImageReport report_;
};

}  // namespace strata::clouds
