// SPDX-License-Identifier: Apache-2.0
/// Everything that can be set about SLAM.
#pragma once

#include "core/base/config.hpp"
#include "core/geometry/odometry_noise.hpp"
#include "core/grid/counting_map.hpp"
#include "core/pose_graph/pose_graph.hpp"
#include "core/registration/correlative_search.hpp"
#include "core/registration/match_field.hpp"
#include "core/registration/scan_matcher.hpp"
#include "core/tracking/tracking_config.hpp"

namespace strata::slam {

/// Loop closures between local maps, and between runs.
struct ClosureConfig {
  bool enabled = true;
  double floor_window_m = 0.3;
  double drift_m_per_m = 0.03;
  double max_window_m = 16.0;
  double floor_window_rad = 0.05;
  double drift_rad_per_m = 0.003;
  double max_window_rad = 0.6;
  int max_points = 400;
  int max_attempts = 6;
  double min_score = 0.45;
  double min_agreement = 0.75;
  double min_overlap = 0.35;
  double stddev_m = 0.03;
  double stddev_rad = 0.005;
  double chain_floor_m = 0.01;
  double chain_per_metre_m = 0.01;
  double chain_floor_rad = 0.003;
  double chain_per_metre_rad = 0.002;
  registration::CorrelativeConfig search;
  pose_graph::PoseGraphConfig graph;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("enabled", c.enabled,
            {.doc = "false: plain incremental scan matching",
             .when = "the robot meets no place twice, or look-alike places are taken for one"});
    v.field("floor_window_m", c.floor_window_m,
            {.doc = "least half-width of the search for a closure", .unit = "m", .min = 0.0});
    v.field("drift_m_per_m", c.drift_m_per_m,
            {.doc = "growth of that window with the path since", .unit = "m/m", .min = 0.0});
    v.field("max_window_m", c.max_window_m, {.doc = "its limit", .unit = "m", .min = 0.0});
    v.field("floor_window_rad", c.floor_window_rad,
            {.doc = "least turn searched for a closure", .unit = "rad", .min = 0.0});
    v.field("drift_rad_per_m", c.drift_rad_per_m,
            {.doc = "growth of that turn with the path since", .unit = "rad/m", .min = 0.0});
    v.field("max_window_rad", c.max_window_rad,
            {.doc = "its limit", .unit = "rad", .min = 0.0, .max = 3.15});
    v.field("max_points", c.max_points,
            {.doc = "surface points of a local map that take part in a search", .min = 10});
    v.field("max_attempts", c.max_attempts,
            {.doc = "older local maps that a new one is searched in, at most", .min = 1});
    v.field("min_score", c.min_score,
            {.doc = "share of points that must be inliers of what a search finds",
             .min = 0.05,
             .max = 1.0});
    v.field("min_agreement", c.min_agreement,
            {.doc = "of the points that fall into seen space, the share that must fall on surface",
             .min = 0.0,
             .max = 1.0});
    v.field("min_overlap", c.min_overlap,
            {.doc = "share of points that must fall into seen space", .min = 0.0, .max = 1.0});
    v.field("stddev_m", c.stddev_m,
            {.doc = "least position uncertainty of a closure", .unit = "m", .min = 1e-3});
    v.field("stddev_rad", c.stddev_rad,
            {.doc = "least heading uncertainty of a closure", .unit = "rad", .min = 1e-4});
    v.field(
        "chain_floor_m", c.chain_floor_m,
        {.doc = "position uncertainty from one local map to the next", .unit = "m", .min = 1e-4});
    v.field("chain_per_metre_m", c.chain_per_metre_m,
            {.doc = "... per metre between them", .unit = "m/m", .min = 0.0});
    v.field(
        "chain_floor_rad", c.chain_floor_rad,
        {.doc = "heading uncertainty from one local map to the next", .unit = "rad", .min = 1e-5});
    v.field("chain_per_metre_rad", c.chain_per_metre_rad,
            {.doc = "... per metre between them", .unit = "rad/m", .min = 0.0});
    v.group("search", c.search, "correlative search");
    v.group("graph", c.graph, "pose graph");
  }
};

/// Poses that come with the log (`--poses`).
struct GivenPoseConfig {
  bool refine = true;
  bool refine_alone = false;
  double stddev_m = 0.1;
  double stddev_rad = 0.05;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("refine", c.refine,
            {.doc = "with several runs: move given poses so that the walls of the runs coincide; "
                    "one run alone keeps them as they are"});
    v.field("refine_alone", c.refine_alone,
            {.doc = "with one run, too: its passes are registered to each other"});
    v.field("stddev_m", c.stddev_m,
            {.doc = "how far given poses are believed to be off", .unit = "m", .min = 1e-3});
    v.field("stddev_rad", c.stddev_rad, {.doc = "... and in heading", .unit = "rad", .min = 1e-4});
  }
};

/// The EM loop over labels, poses and map.
struct RefinementConfig {
  bool match_again = true;
  int max_iterations = 10;
  double min_gain = 1e-3;
  double prior_stddev_m = 0.1;
  double prior_stddev_rad = 0.02;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    describe_fields(c, v);
    v.removed("track_again", "only slam tracks again (slam.em.track_again)");
  }

 protected:
  template <class Self, class V>
  static void describe_fields(Self& c, V& v) {
    v.field("match_again", c.match_again,
            {.doc = "match every scan again to the map of static beams, round by round"});
    v.field("max_iterations", c.max_iterations, {.doc = "rounds, at most", .min = 0});
    v.field("min_gain", c.min_gain,
            {.doc = "stop after two rounds that each raise the log likelihood by less than this "
                    "share of it",
             .min = 0.0});
    v.field("prior_stddev_m", c.prior_stddev_m,
            {.doc = "how far matching again may move a scan", .unit = "m", .min = 1e-3});
    v.field("prior_stddev_rad", c.prior_stddev_rad,
            {.doc = "... and turn it", .unit = "rad", .min = 1e-4});
  }
};

/// The same as a part of slam.
struct EmConfig : RefinementConfig {
  bool track_again = true;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("track_again", c.track_again,
            {.doc = "once the dynamic beams are known, track and close loops anew without them"});
    describe_fields(c, v);
  }
};

}  // namespace strata::slam
