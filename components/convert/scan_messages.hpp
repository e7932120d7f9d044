// SPDX-License-Identifier: Apache-2.0
/// Scans: every float keeps its bits both ways.
#pragma once

#include <optional>
#include <string>

#include "strata_idl/sensor_msgs.h"
#include "strata_idl/strata_msgs.h"

#include "core/scan/scan.hpp"

namespace strata::convert {

/// The mounting is not part of the message; it travels in tf_static.
[[nodiscard]] sensor_msgs::msg::LaserScan to_message(const Scan& scan, const std::string& frame);
[[nodiscard]] Scan from_message(const sensor_msgs::msg::LaserScan& message,
                                const Pose2& robot_from_laser);

/// frame: of the pose (the map); the scan keeps `laser_frame`.
[[nodiscard]] strata_msgs::msg::LabeledScan to_message(const PosedScan& scan,
                                                       const std::string& frame,
                                                       const std::string& laser_frame);
[[nodiscard]] PosedScan from_message(const strata_msgs::msg::LabeledScan& message);

/// The pose that `given` says of the scan of its stamp, which gets its run; nothing for another
/// scan, or when the pose is not known.
[[nodiscard]] std::optional<Pose2> take_given(
    const std::optional<strata_msgs::msg::ScanPose>& given, Observation& observation);

}  // namespace strata::convert
