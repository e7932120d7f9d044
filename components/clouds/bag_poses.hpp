// SPDX-License-Identifier: Apache-2.0
/// Where sensors of a bag were: from its tf, or from poses that are given.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "components/log/transform_history.hpp"
#include "core/base/time.hpp"
#include "core/geometry/pose3.hpp"
#include "core/volume/cloud.hpp"

namespace strata::clouds {

/// How 3-D data of a bag are read.
struct CloudReadOptions {
  std::string points_topic;  ///< empty: the first by name
  std::string robot_frame = "base_link";
  /// map_from_robot at a moment, instead of what tf says; empty: tf.
  volume::SensorPoses robot_poses;
  /// Clouds whose points say when they were measured are cut into parts of this; 0: they are not.
  double part_s = 0.02;
};

/// What 3-D mapping can use of a bag; one pass over it.
class BagPoses {
 public:
  /// Throws InputError when the bag cannot be read.
  BagPoses(const std::filesystem::path& bag, CloudReadOptions options);

  /// map_from_FRAME at a moment; the map is the frame map, or odom where tf knows no map.
  [[nodiscard]] std::optional<Pose3> find(const std::string& frame, Stamp stamp) const;
  /// Whether tf itself connects something to the frame map.
  [[nodiscard]] bool knows_map() const { return transforms_.knows("map"); }
  /// The names of topics of a type, "sensor_msgs/msg/PointCloud2".
  [[nodiscard]] std::set<std::string> topics_of(const std::string& type) const;
  [[nodiscard]] const std::string& map_frame() const { return map_frame_; }
  /// What of tf could not be read.
  [[nodiscard]] const std::vector<std::string>& bad() const { return bad_; }

 private:
  void add_transforms(const std::vector<std::uint8_t>& bytes, bool is_static);

  std::filesystem::path path_;
  CloudReadOptions options_;
  log::TransformHistory transforms_;
  std::string map_frame_ = "odom";
  std::set<std::pair<std::string, std::string>> topics_;  ///< type, name
  std::vector<std::string> bad_;
};

/// Whether a path is a bag; told by content.
[[nodiscard]] bool is_bag(const std::filesystem::path& path);

}  // namespace strata::clouds
