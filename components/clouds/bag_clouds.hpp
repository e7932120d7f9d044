// SPDX-License-Identifier: Apache-2.0
/// Clouds of a rosbag2 bag, with poses from its tf.
#pragma once

#include <filesystem>
#include <memory>

#include "components/clouds/cloud_reader.hpp"

namespace strata::clouds {

/// One sensor_msgs/PointCloud2 topic, posed in `map` if tf knows it or poses are given, else in
/// `odom`. Clouds whose pose is not known are left out and counted, as are messages that make no
/// sense. Reads the bag once for tf, then as it goes for clouds. Throws InputError when there is no
/// cloud topic.
[[nodiscard]] std::unique_ptr<CloudReader> open_bag_clouds(const std::filesystem::path& path,
                                                           const CloudReadOptions& options = {});

}  // namespace strata::clouds
