// SPDX-License-Identifier: Apache-2.0
/// Point clouds in, octrees out.
#pragma once

#include <cstdint>
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

/// What a cloud may say of each point beyond its place; empty where it does not.
struct CloudColumns {
  std::vector<float> offset_s;             ///< when it was measured, after the header's stamp
  std::vector<std::uint8_t> truly_moving;  ///< a simulator's truth
  std::vector<std::uint32_t> rgb{};        ///< 0xRRGGBB
};
/// The time of a point from a field time, t or timestamp: floating point in seconds, uint32 in
/// nanoseconds; numbers that only fit a clock are taken as such. The truth from a field moving
/// (uint8). Colours from a field rgb or rgba, packed as PCL packs them: uint32, or its bits as
/// float32. Fields of other types are taken for missing. Throws as from_message.
[[nodiscard]] CloudColumns columns_of(const sensor_msgs::msg::PointCloud2& message);

/// One row of float32 x, y, z, then float32 time, uint8 moving and float32 rgb where
/// columns has them.
[[nodiscard]] sensor_msgs::msg::PointCloud2 to_message(const std::vector<Eigen::Vector3f>& points_m,
                                                       Stamp stamp, const std::string& frame,
                                                       const CloudColumns& columns = {});

/// The full form of octomap_msgs; data: what PointColors::message_data gives.
[[nodiscard]] octomap_msgs::msg::Octomap to_color_octomap(const std::string& data,
                                                          double resolution_m, Stamp stamp,
                                                          const std::string& frame);

/// The binary form of octomap_msgs; data: what VolumeMap::binary_message_data gives.
[[nodiscard]] octomap_msgs::msg::Octomap to_binary_octomap(const std::string& data,
                                                           double resolution_m, Stamp stamp,
                                                           const std::string& frame);

}  // namespace strata::convert
