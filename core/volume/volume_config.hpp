// SPDX-License-Identifier: Apache-2.0
/// Settings of 3-D maps; the defaults are OctoMap's.
#pragma once

#include <vector>

#include "core/base/config.hpp"

namespace strata::volume {

struct VolumeConfig {
  double resolution_m = 0.1;
  /// 0: no limit.
  double max_range_m = 0.0;
  double probability_hit = 0.7;
  double probability_miss = 0.4;
  double min_probability = 0.1192;
  double max_probability = 0.971;
  /// Empty: everywhere; otherwise x0, y0, z0, x1, y1, z1.
  std::vector<double> box_m;

  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("resolution_m", c.resolution_m,
            {.doc = "edge of a voxel",
             .unit = "m",
             .min = 0.001,
             .max = 10.0,
             .when = "the 3-D map shall be finer or coarser; half the edge needs up to eight times "
                     "the memory"});
    v.field("max_range_m", c.max_range_m,
            {.doc = "points further away only free the space up to this range; 0: no limit",
             .unit = "m",
             .min = 0.0});
    v.field("probability_hit", c.probability_hit,
            {.doc = "occupancy that one point in a voxel speaks for",
             .unit = "1",
             .min = 0.5,
             .max = 0.999});
    v.field("probability_miss", c.probability_miss,
            {.doc = "occupancy that one ray through a voxel speaks for",
             .unit = "1",
             .min = 0.001,
             .max = 0.5});
    v.renamed("least_probability", "min_probability");
    v.field("min_probability", c.min_probability,
            {.doc = "occupancy never falls below this", .unit = "1", .min = 0.001, .max = 0.499});
    v.renamed("most_probability", "max_probability");
    v.field("max_probability", c.max_probability,
            {.doc = "occupancy never rises above this", .unit = "1", .min = 0.501, .max = 0.999});
    v.field("box_m", c.box_m,
            {.doc = "x0, y0, z0, x1, y1, z1 of the part of the map frame to keep; empty: all",
             .unit = "m"});
    const bool is_box = c.box_m.empty() || (c.box_m.size() == 6 && c.box_m[0] < c.box_m[3] &&
                                            c.box_m[1] < c.box_m[4] && c.box_m[2] < c.box_m[5]);
    v.require(is_box, "box_m", "is no box", "give x0, y0, z0, x1, y1, z1 with x0 < x1 and so on");
  }
};

}  // namespace strata::volume
