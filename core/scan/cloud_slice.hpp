// SPDX-License-Identifier: Apache-2.0
/// A planar scan out of a point cloud.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/base/config.hpp"
#include "core/geometry/pose3.hpp"
#include "core/scan/scan.hpp"

namespace strata {

/// Which points of a cloud a planar scan is made of.
struct CloudSliceConfig {
  double min_height_m = 0.2;
  double max_height_m = 0.5;
  double angle_increment_rad = 0.0087;
  double min_range_m = 0.3;
  double max_range_m = 30.0;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("min_height_m", c.min_height_m,
            {.doc = "lowest point that counts, above the robot's frame: no floor",
             .unit = "m",
             .when = "ramps, sills or an uneven floor show up as walls: raise it"});
    v.field("max_height_m", c.max_height_m,
            {.doc = "highest point that counts",
             .unit = "m",
             .when = "the scanner sits higher, or things above the robot show up as walls"});
    v.require(c.min_height_m < c.max_height_m, "max_height_m", "is not above min_height_m",
              "give a slice with some height");
    v.field("angle_increment_rad", c.angle_increment_rad,
            {.doc = "angle between two beams of the scan", .unit = "rad", .min = 1e-3, .max = 0.5});
    v.field("min_range_m", c.min_range_m,
            {.doc = "nearer points are the robot itself", .unit = "m", .min = 0.0});
    v.field("max_range_m", c.max_range_m,
            {.doc = "further points do not count", .unit = "m", .min = 0.1, .max = 1000.0});
  }
};

/// A scan whose beams need not have been taken evenly one after the other.
struct CloudSlice {
  Scan scan;
  /// When the point of each beam was measured, after the scan's stamp; empty where the cloud does
  /// not say.
  std::vector<float> offset_s;
};

/// All round, seen from the sensor's place in the plane: in each direction the nearest point
/// between the two heights above the robot's frame, and NaN where there is none, since a slice
/// without a point may have been looked over or under. points_m: in the sensor's frame, NaN for
/// none. offset_s: empty, or one a point. robot_from_sensor: of any attitude. O(points + beams).
[[nodiscard]] CloudSlice slice_cloud(std::span<const Eigen::Vector3f> points_m,
                                     std::span<const float> offset_s, Stamp stamp,
                                     const Pose3& robot_from_sensor,
                                     const CloudSliceConfig& config);

}  // namespace strata
