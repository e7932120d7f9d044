// SPDX-License-Identifier: Apache-2.0
/// Everything that can be set about mapping one run topologically, from its scans on.
#pragma once

#include "core/base/config.hpp"
#include "core/geometry/odometry_noise.hpp"
#include "core/pose_graph/pose_graph.hpp"
#include "core/slam/slam_config.hpp"
#include "core/topology/config.hpp"
#include "core/topology/visit_maker.hpp"

namespace strata::topology {

/// Odometry between landmarks that scan matching has corrected.
inline constexpr OdometryNoiseConfig kMatchedOdometryNoise{.floor_m = 0.05,
                                                           .per_metre_m = 0.015,
                                                           .floor_rad = 0.01,
                                                           .per_metre_rad = 0.003,
                                                           .per_radian_rad = 0.0};

/// For landmarks as the detector finds them: rooms and junctions of an office lie nearer to each
/// other than the paper's, whose penalty reaches 10 m. The detector takes two findings within
/// LandmarkConfig::same_m for one, so that no two landmarks lie nearer, and many not much further.
/// Places within a metre of each other are to be one landmark, others not. A visit at distance d
/// of a landmark's first is as likely there as at a new landmark anywhere in the area A where
///   d^2 = 2 sigma^2 (ln(A / (2 pi sigma^2)) + f(d)),
/// f the penalty of two landmarks at that distance; sigma = 0.2 m makes that 0.97 m on 500
/// m^2, 1.03 m on 4,000. It is more than the detector needs (0.10 and 0.12 m a coordinate between
/// two visits of one place on real logs, 0.6 m at most); the paper's half a metre would merge
/// places two metres apart.
[[nodiscard]] inline TopologyConfig detected_landmarks() {
  TopologyConfig config;
  config.odometry = kMatchedOdometryNoise;
  config.location.penalty_radius_m = LandmarkConfig{}.same_m;
  config.location.revisit_stddev_m = 0.2;
  return config;
}

/// What a robot that works for days keeps of its way: memory does not grow while it stands, and
/// ends growing when the budget is used up. Of a log everything is kept.
struct PathKeepConfig {
  double subsample_m = 0.0;
  double subsample_rad = 0.0;
  double memory_mb = 0.0;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.renamed("thin_m", "subsample_m");
    v.field("subsample_m", c.subsample_m,
            {.doc = "scans nearer than this to the last one kept, and turned by less than "
                    "subsample_rad, are matched but not kept",
             .unit = "m",
             .min = 0.0});
    v.renamed("thin_rad", "subsample_rad");
    v.field("subsample_rad", c.subsample_rad,
            {.doc = "see subsample_m", .unit = "rad", .min = 0.0});
    v.field("memory_mb", c.memory_mb,
            {.doc = "scans are kept up to this; then the map is complete and the mapper takes no "
                    "more. About 4 bytes a beam: 512 MB hold 6 km of scans of 1,080 beams every 5 "
                    "cm. The landmarks' visits come on top, some 0.3 MB each; 0: no bound",
             .unit = "MB",
             .min = 0.0});
  }
};

struct TopologyMapperConfig {
  bool match_scans = true;
  double resolution_m = 0.05;
  slam::TrackingConfig tracking;
  LandmarkVisitConfig landmarks;
  TopologyConfig topology = detected_landmarks();
  double node_distance_m = 0.25;
  double node_turn_rad = 0.25;
  PathNoiseConfig way;
  pose_graph::PoseGraphConfig pose_graph;
  slam::GivenPoseConfig pose_prior{.refine_alone = true, .stddev_m = 0.2};
  slam::ClosureConfig closure;
  slam::RefinementConfig refinement;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("match_scans", c.match_scans,
            {.doc = "correct the odometry by matching each scan to the last metres; else raw"});
    v.field("resolution_m", c.resolution_m, {.doc = "cells of the map", .unit = "m", .min = 0.01});
    v.group("tracking", c.tracking, "scan matching");
    v.group("landmarks", c.landmarks, "where landmarks are");
    v.group("topology", c.topology, "the posterior over topologies");
    v.field("node_distance_m", c.node_distance_m,
            {.doc = "scans this far apart are poses of the graph", .unit = "m", .min = 0.05});
    v.field("node_turn_rad", c.node_turn_rad,
            {.doc = "... and those turned by this much", .unit = "rad", .min = 0.05});
    v.group("way", c.way, "noise between two poses of the graph");
    v.group("pose_graph", c.pose_graph, "optimization of the metric map");
    v.renamed("tie", "pose_prior");
    v.group("pose_prior", c.pose_prior,
            "how far poses may be off once landmarks hold them, when passes are registered to each "
            "other");
    v.group("closure", c.closure, "which passes are registered to each other");
    v.group("refinement", c.refinement,
            "matching every scan again to the metric map, as SLAM does");
  }
};

}  // namespace strata::topology
