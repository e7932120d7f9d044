// SPDX-License-Identifier: Apache-2.0
/// Point clouds in, octrees out.
#pragma once

#include <string>
#include <vector>

#include "strata_idl/octomap_msgs.h"
#include "strata_idl/sensor_msgs.h"
#include <Eigen/Core>

#include "core/base/time.hpp"

namespace strata::convert {

/// The fields x, y and z, float32 or float64, wherever they lie in a point; NaN stays NaN. Throws
/// InputError when one is missing or of another type, for big-endian data, and when the sizes that
/// the message states do not fit its data. O(points).
[[nodiscard]] std::vector<Eigen::Vector3f> from_message(
    const sensor_msgs::msg::PointCloud2& message);

/// One row of float32 x, y, z.
[[nodiscard]] sensor_msgs::msg::PointCloud2 to_message(const std::vector<Eigen::Vector3f>& points_m,
                                                       Stamp stamp, const std::string& frame);

/// The binary form of octomap_msgs; data: what VolumeMap::binary_message_data gives.
[[nodiscard]] octomap_msgs::msg::Octomap to_binary_octomap(const std::string& data,
                                                           double resolution_m, Stamp stamp,
                                                           const std::string& frame);

}  // namespace strata::convert
