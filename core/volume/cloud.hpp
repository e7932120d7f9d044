// SPDX-License-Identifier: Apache-2.0
/// One 3-D scan.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "core/base/time.hpp"
#include "core/geometry/pose3.hpp"

namespace strata::volume {

struct Cloud {
  Stamp stamp;
  Pose3 map_from_sensor;
  std::vector<Eigen::Vector3f> points_m;  ///< in the sensor's frame; may hold NaN
};

}  // namespace strata::volume
