// SPDX-License-Identifier: Apache-2.0
/// Everything that can be set about incremental scan matching.
#pragma once

#include "core/base/config.hpp"
#include "core/geometry/odometry_noise.hpp"
#include "core/registration/match_field.hpp"
#include "core/registration/scan_matcher.hpp"

namespace strata::slam {

/// Incremental scan matching of one run against its own recent past.
struct TrackingConfig {
  double key_distance_m = 0.1;
  double key_turn_rad = 0.0873;
  int local_map_keys = 40;
  double local_map_length_m = 10.0;
  double max_range_m = 30.0;
  int max_beams = 180;
  double good_match = 0.8;
  double poor_match = 0.6;
  double search_window_m = 0.5;
  double search_turn_rad = 0.35;
  OdometryNoiseConfig odometry;
  registration::MatchConfig match;
  registration::MatchFieldConfig field;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("key_distance_m", c.key_distance_m,
            {.doc = "a scan enters the map after this much driving", .unit = "m", .min = 0.0});
    v.field("key_turn_rad", c.key_turn_rad,
            {.doc = "... or after this much turning", .unit = "rad", .min = 0.0});
    v.renamed("submap_keys", "local_map_keys");
    v.field("local_map_keys", c.local_map_keys,
            {.doc = "map scans between the beginnings of two local maps; each holds twice as many",
             .min = 4});
    v.renamed("submap_length_m", "local_map_length_m");
    v.field("local_map_length_m", c.local_map_length_m,
            {.doc = "... or so much path, where map scans lie far apart", .unit = "m", .min = 1.0});
    v.field("max_range_m", c.max_range_m,
            {.doc = "longer beams take no part in matching",
             .unit = "m",
             .min = 1.0,
             .when = "far readings of your scanner are not to be trusted, or a hall is larger"});
    v.field("max_beams", c.max_beams,
            {.doc = "beams of a scan that are matched, evenly spread; 0: all", .min = 0});
    v.field("good_match", c.good_match,
            {.doc = "below this share of inlier beams other starts than odometry are tried: "
                    "going on as before, turning only, driving backwards",
             .unit = "1",
             .min = 0.0,
             .max = 1.0});
    v.field("poor_match", c.poor_match,
            {.doc = "below this share of inlier beams a correlative search is tried",
             .unit = "1",
             .min = 0.0,
             .max = 1.0});
    v.field("search_window_m", c.search_window_m,
            {.doc = "half-width of the correlative search after a poor match",
             .unit = "m",
             .min = 0.0});
    v.field("search_turn_rad", c.search_turn_rad,
            {.doc = "... and how far it turns", .unit = "rad", .min = 0.0, .max = 3.15});
    v.group("odometry", c.odometry, "noise of odometry between two scans");
    v.group("match", c.match, "scan matching");
    v.group("field", c.field, "the map as matching sees it");
  }
};

}  // namespace strata::slam
