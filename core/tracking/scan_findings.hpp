// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/geometry/pose2.hpp"

namespace strata::slam {

/// What the tracker noticed about one scan.
struct ScanFindings {
  bool matched = false;
  bool empty = false;            ///< the scan hit nothing
  bool few = false;              ///< it hit too little to be matched
  bool ambiguous = false;        ///< the scan leaves its position open in some direction
  bool heading_open = false;     ///< the scan leaves its heading open
  bool odometry_jumped = false;  ///< odometry moved faster than a robot can, and was not believed
  Pose2 odometry_step;           ///< since the scan before; identity without odometry
  Pose2 matched_step;
};

}  // namespace strata::slam
