// SPDX-License-Identifier: Apache-2.0
/// Clouds and images of a simulation as messages of a bag.
#pragma once

#include <cstddef>

#include "components/log/log_writer.hpp"
#include "tools/simulate/simulation.hpp"

namespace strata::simulate {

/// Of the days [first, last): /points (sensor_msgs/PointCloud2 in the frame "scanner3"; a field
/// moving is 1 on people; a tilting scanner adds time, after the header's stamp), and
/// /camera/image_raw with /camera/camera_info (frame "camera_optical"), with where both sit on the
/// robot. Empty for a scenario without them.
[[nodiscard]] log::LogExtras space_messages(const Simulation& simulation, std::size_t first,
                                            std::size_t last);

}  // namespace strata::simulate
