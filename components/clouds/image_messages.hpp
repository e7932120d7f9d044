// SPDX-License-Identifier: Apache-2.0
/// Pictures of cameras and their calibration.
#pragma once

#include <string>

#include "strata_idl/sensor_msgs.h"

#include "core/base/time.hpp"
#include "core/volume/camera.hpp"

namespace strata::convert {

/// Encodings rgb8, bgr8, rgba8, bgra8 and mono8, rows padded or not. Throws InputError for others,
/// and when the sizes that the message states do not fit its data. O(pixels).
[[nodiscard]] volume::ColorImage from_message(const sensor_msgs::msg::Image& message);
/// rgb8.
[[nodiscard]] sensor_msgs::msg::Image to_message(const volume::ColorImage& image, Stamp stamp,
                                                 const std::string& frame);

/// Of the raw picture: k and d; models plumb_bob and rational_polynomial, or no d. Throws
/// InputError for another model, a focal length that is not positive, and binning or a region of
/// interest, which are not supported.
[[nodiscard]] volume::Camera from_message(const sensor_msgs::msg::CameraInfo& message);
[[nodiscard]] sensor_msgs::msg::CameraInfo to_message(const volume::Camera& camera, Stamp stamp,
                                                      const std::string& frame);

}  // namespace strata::convert
