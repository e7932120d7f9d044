// SPDX-License-Identifier: Apache-2.0
/// From one run to its topologies and the metric map of the likeliest one.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/progress.hpp"
#include "core/grid/reflection_grid.hpp"
#include "core/pose_graph/pose_graph.hpp"
#include "core/scan/scan.hpp"
#include "core/slam/slam_config.hpp"
#include "core/topology/topology_filter.hpp"
#include "core/topology/visit_maker.hpp"

namespace strata::pipeline {

/// How scan matching over a short way goes wrong over a long one; standard deviations per square
/// root of a metre.
struct WayNoiseConfig {
  double per_root_metre_m = 0.02;
  double per_root_metre_rad = 0.006;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("per_root_metre_m", c.per_root_metre_m,
            {.doc = "position noise of a metre", .unit = "m", .min = 1e-4});
    v.field("per_root_metre_rad", c.per_root_metre_rad,
            {.doc = "heading noise of a metre", .unit = "rad", .min = 1e-4});
  }
};

/// Odometry between landmarks that scan matching has corrected.
inline constexpr OdometryNoiseConfig kMatchedOdometryNoise{.floor_m = 0.05,
                                                           .per_metre_m = 0.015,
                                                           .floor_rad = 0.01,
                                                           .per_metre_rad = 0.003,
                                                           .per_radian_rad = 0.0};

/// For landmarks as the detector finds them: rooms and junctions of an office lie nearer to each
/// other than the paper's, whose penalty reaches 10 m.
[[nodiscard]] inline topology::TopologyConfig detected_landmarks() {
  topology::TopologyConfig config;
  config.odometry = kMatchedOdometryNoise;
  config.location.penalty_radius_m = 3.0;
  return config;
}

struct TopologyMapConfig {
  bool match_scans = true;
  double resolution_m = 0.05;
  slam::TrackingConfig tracking;
  topology::VisitConfig landmarks;
  topology::TopologyConfig topology = detected_landmarks();
  double node_distance_m = 0.25;
  WayNoiseConfig way;
  pose_graph::PoseGraphConfig pose_graph;
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
    v.group("way", c.way, "noise between two poses of the graph");
    v.group("pose_graph", c.pose_graph, "optimization of the metric map");
  }
};

struct TopologyMap {
  std::vector<topology::MadeVisit> visits;
  std::vector<topology::Hypothesis> posterior;  ///< most probable first
  /// Of the most probable hypothesis: pose of every visit, in the frame of the first scan.
  std::vector<Pose2Gaussian> locations;
  topology::TopologyCounts counts;
  std::vector<double> update_ms;  ///< CPU is the caller's; wall time of each visit's update
  bool optimized = false;         ///< the pose graph converged
  std::vector<PosedScan> scans;   ///< with their poses after optimization
  std::vector<Pose2> tracked;     ///< ... and before
  ReflectionGrid map;
};

/// observations: one run in time order. landmark_times_s: seconds from the first scan; replaces
/// detection. given: empty, or one an observation, used instead of odometry and scan matching where
/// it is known. The map frame is that of the first scan's odometry. Deterministic for a seed at any
/// number of threads, but update_ms. Throws Cancelled, and InputError without two landmarks.
[[nodiscard]] TopologyMap map_topology(const std::vector<Observation>& observations,
                                       const std::vector<std::optional<Pose2>>& given,
                                       std::optional<std::span<const double>> landmark_times_s,
                                       const TopologyMapConfig& config, std::uint64_t seed,
                                       int threads, Progress* progress);

/// Pairs of visits whose places are known from a true trajectory.
struct TopologyAgreement {
  std::size_t near = 0;         ///< places within the distance of each other ...
  std::size_t near_merged = 0;  ///< ... that the topology holds to be one landmark
  std::size_t far = 0;          ///< places at least twice that far apart ...
  std::size_t far_merged = 0;   ///< ... that it takes for one, wrongly
};
/// Of all pairs of visits whose scans have a true pose. truths: one an observation, in any frame.
[[nodiscard]] TopologyAgreement agreement(const TopologyMap& result,
                                          const topology::Hypothesis& hypothesis,
                                          const std::vector<Observation>& observations,
                                          const std::vector<std::optional<Pose2>>& truths,
                                          double near_m);

/// Times in seconds from the first scan, one a line; `#` begins a comment. Throws InputError with
/// file and line.
[[nodiscard]] std::vector<double> read_landmark_times(const std::string& path);

}  // namespace strata::pipeline
