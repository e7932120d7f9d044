// SPDX-License-Identifier: Apache-2.0
/// Clouds of a rosbag2 bag, with poses from its tf.
#pragma once

#include <filesystem>
#include <memory>

#include "components/log/cloud_reader.hpp"

namespace strata::log {

/// The first sensor_msgs/PointCloud2 topic by name, posed in `map` if tf knows it, else in `odom`.
/// Clouds whose pose tf does not tell are left out and counted, as are messages that make no sense.
/// Reads the bag once for tf, then as it goes for clouds. Throws InputError when there is no cloud
/// topic.
[[nodiscard]] std::unique_ptr<CloudReader> open_bag_clouds(const std::filesystem::path& path);

}  // namespace strata::log
