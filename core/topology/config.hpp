// SPDX-License-Identifier: Apache-2.0
/// Everything that can be set about topological mapping.
#pragma once

#include <array>
#include <utility>

#include "core/base/config.hpp"
#include "core/geometry/odometry_noise.hpp"

namespace strata::topology {

/// Of wheels over the metres between two landmarks, where errors have partly averaged out.
inline constexpr OdometryNoiseConfig kLandmarkOdometryNoise{.floor_m = 0.05,
                                                            .per_metre_m = 0.05,
                                                            .floor_rad = 0.035,
                                                            .per_metre_rad = 0.0035,
                                                            .per_radian_rad = 0.0};

/// Where landmarks lie, before any measurement says so.
struct LocationPriorConfig {
  double revisit_stddev_m = 0.5;
  double penalty_radius_m = 10.0;
  double max_penalty = 15.0;
  double area_margin_m = 10.0;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("revisit_stddev_m", c.revisit_stddev_m,
            {.doc = "how far two visits of one landmark lie apart",
             .unit = "m",
             .min = 0.01,
             .preset = {"paper-topology", "0.5"}});
    v.field("penalty_radius_m", c.penalty_radius_m,
            {.doc = "distinct landmarks closer than this are penalized",
             .unit = "m",
             .min = 0.1,
             .preset = {"paper-topology", "10"}});
    v.field("max_penalty", c.max_penalty,
            {.doc = "penalty of two landmarks at one place", .unit = "nats", .min = 0.0});
    v.field("area_margin_m", c.area_margin_m,
            {.doc = "a new landmark may lie this far outside of what the odometry has covered",
             .unit = "m",
             .min = 1.0});
  }
};

/// Matching of the local clouds around two visits.
struct CloudMatchConfig {
  double first_gate_m = 0.5;
  double last_gate_m = 0.1;
  double robust_scale_m = 0.05;
  double noise_m = 0.03;
  double effective_points = 30.0;
  double hit_share = 0.9;
  double max_distance_m = 1.0;
  double min_overlap = 0.3;
  double failure_gain = -5.0;
  double look_alike_gain = 20.0;
  int max_iterations = 30;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("first_gate_m", c.first_gate_m,
            {.doc = "largest distance of two matched points at first", .unit = "m", .min = 0.01});
    v.field("last_gate_m", c.last_gate_m, {.doc = "... at last", .unit = "m", .min = 0.01});
    v.field("robust_scale_m", c.robust_scale_m,
            {.doc = "distance at which the pull of a point begins to fade (Cauchy)",
             .unit = "m",
             .min = 1e-3});
    v.field("noise_m", c.noise_m,
            {.doc = "standard deviation of a point from its surface", .unit = "m", .min = 1e-3});
    v.field("effective_points", c.effective_points,
            {.doc = "independent measurements that a whole cloud counts as: its points are "
                    "correlated",
             .min = 1.0});
    v.field("hit_share", c.hit_share,
            {.doc = "share of points that belong to a surface of the same place",
             .unit = "1",
             .min = 0.01,
             .max = 0.99});
    v.field("max_distance_m", c.max_distance_m,
            {.doc = "points of another place lie evenly within this distance of a surface",
             .unit = "m",
             .min = 0.1});
    v.field("min_overlap", c.min_overlap,
            {.doc = "matching has failed below this share of points near a surface",
             .unit = "1",
             .min = 0.0,
             .max = 1.0});
    v.field("failure_gain", c.failure_gain,
            {.doc = "log likelihood of the same place after a failed match, against another place",
             .unit = "nats",
             .max = 0.0});
    v.field("look_alike_gain", c.look_alike_gain,
            {.doc = "log likelihood of the same place after the best of matches, against another "
                    "place, which may look the same: no match says more",
             .unit = "nats",
             .min = 0.0});
    v.field("max_iterations", c.max_iterations, {.doc = "rounds of matching, at most", .min = 1});
  }
};

enum class Proposal { kOdometry, kPrior };
enum class Weighting { kCorrected, kPaper };
enum class Expansion { kParticles, kBest };

/// The filter over topologies.
struct TopologyConfig {
  int particles = 50;
  double concentration = 3.0;
  Proposal proposal = Proposal::kOdometry;
  Weighting weighting = Weighting::kCorrected;
  Expansion expansion = Expansion::kBest;
  double negligible = 20.0;
  OdometryNoiseConfig odometry = kLandmarkOdometryNoise;
  LocationPriorConfig location;
  CloudMatchConfig match;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("particles", c.particles, {.doc = "topologies kept, at most", .min = 1});
    v.field("concentration", c.concentration,
            {.doc = "c of the Dirichlet process: larger expects more landmarks", .min = 1e-6});
    v.field("proposal", c.proposal, {.doc = "labels drawn with the odometry, or blindly"});
    v.field("weighting", c.weighting,
            {.doc = "corrected: with the proposal's normalizer; paper: as printed, without",
             .preset = {"paper-topology", "paper"}});
    v.field("expansion", c.expansion,
            {.doc = "best: the most probable topologies, without chance; particles: drawn, as the "
                    "paper does",
             .preset = {"paper-topology", "particles"}});
    v.field("negligible", c.negligible,
            {.doc = "labels less probable than the likeliest by this are not followed",
             .unit = "nats",
             .min = 5.0});
    v.group("odometry", c.odometry, "noise between two landmarks");
    v.group("location", c.location, "where landmarks lie");
    v.group("match", c.match, "matching of local clouds");
  }
};

}  // namespace strata::topology

template <>
struct strata::EnumNames<strata::topology::Proposal> {
  static constexpr std::array values{std::pair{strata::topology::Proposal::kOdometry, "odometry"},
                                     std::pair{strata::topology::Proposal::kPrior, "prior"}};
};
template <>
struct strata::EnumNames<strata::topology::Weighting> {
  static constexpr std::array values{
      std::pair{strata::topology::Weighting::kCorrected, "corrected"},
      std::pair{strata::topology::Weighting::kPaper, "paper"}};
};
template <>
struct strata::EnumNames<strata::topology::Expansion> {
  static constexpr std::array values{
      std::pair{strata::topology::Expansion::kParticles, "particles"},
      std::pair{strata::topology::Expansion::kBest, "best"}};
};
