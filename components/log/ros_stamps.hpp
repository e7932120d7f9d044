// SPDX-License-Identifier: Apache-2.0
/// The stamps that ROS 2 can carry: 32 bits of seconds.
#pragma once

#include <span>
#include <string>

#include "components/log/odometry_track.hpp"
#include "core/scan/scan.hpp"

namespace strata::log {

/// From -2^31 s up to 2^31 s (the year 2038).
[[nodiscard]] bool is_ros_stamp(Stamp stamp);
/// Throws InputError (place) for one that messages cannot carry.
void require_ros_stamp(Stamp stamp, const std::string& place);
/// Throws InputError at the first stamp that messages cannot carry. place: the log's name. O(scans
/// + samples).
void require_ros_stamps(std::span<const Observation> observations,
                        std::span<const OdometrySample> odometry, const std::string& place);

}  // namespace strata::log
