// SPDX-License-Identifier: Apache-2.0
/// Everything about the filter that does not depend on the map model.
#pragma once

#include "core/geometry/odometry_noise.hpp"
#include "core/localization/beyond_map.hpp"
#include "core/localization/motion_model.hpp"
#include "core/localization/place_finder.hpp"
#include "core/localization/recovery.hpp"
#include "core/localization/resampling.hpp"

namespace strata::localization {

/// When a scan is weighed. Every scan gets a pose: particles always follow the odometry.
struct GatingConfig {
  double translation_m = 0.10;
  double rotation_rad = 0.0873;
  int every_scans = 10;
  double max_speed_mps = OdometryLimits{}.speed_mps;
  double jump_m = OdometryLimits{}.slack_m;
  double max_turn_rps = OdometryLimits{}.turn_rps;
  double jump_rad = OdometryLimits{}.slack_rad;

  [[nodiscard]] OdometryLimits limits() const {
    return {.speed_mps = max_speed_mps,
            .slack_m = jump_m,
            .turn_rps = max_turn_rps,
            .slack_rad = jump_rad};
  }
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("translation_m", c.translation_m,
            {.doc = "weigh a scan after this much driving",
             .unit = "m",
             .min = 0.0,
             .when = "the processor is too slow (raise it), or poses lag behind (lower it)"});
    v.field("rotation_rad", c.rotation_rad,
            {.doc = "or this much turning", .unit = "rad", .min = 0.0});
    v.field("every_scans", c.every_scans,
            {.doc = "or at the latest every so many scans of each scanner; 1: weigh all",
             .unit = "scans",
             .min = 1});
    v.renamed("most_speed_mps", "max_speed_mps");
    v.field("max_speed_mps", c.max_speed_mps,
            {.doc = "with jump_m: odometry that moves faster than a robot can has been reset, and "
                    "says nothing",
             .unit = "m/s",
             .min = 0.0});
    v.field(
        "jump_m", c.jump_m,
        {.doc = "odometry may always move this far between two scans", .unit = "m", .min = 0.0});
    v.field("max_turn_rps", c.max_turn_rps,
            {.doc = "with jump_rad: the same of odometry that turns faster than a robot can",
             .unit = "rad/s",
             .min = 0.0});
    v.field(
        "jump_rad", c.jump_rad,
        {.doc = "odometry may always turn this far between two scans", .unit = "rad", .min = 0.0});
  }
};

/// Start without a pose (docs/theory/patch_localization.md, "Global start"), flat at first: in a
/// plain corridor the scans of many places fit alike, and chance errors of the map, which all scans
/// share, must not decide between them before the robot has seen more.
struct GlobalStartConfig {
  double particles_per_m2 = 500.0;
  int max_particles = 60000;
  int annealing_updates = 32;
  double annealing_factor = 8.0;
  double roughening = 0.5;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("particles_per_m2", c.particles_per_m2,
            {.doc = "particles per free area", .unit = "1/m^2", .min = 1.0});
    v.renamed("most_particles", "max_particles");
    v.field("max_particles", c.max_particles, {.doc = "never more", .unit = "particles", .min = 1});
    v.field(
        "annealing_updates", c.annealing_updates,
        {.doc = "weighed scans until the temperature is the one for tracking; fewer when one place "
                "is left before",
         .unit = "scans",
         .min = 0});
    v.field("annealing_factor", c.annealing_factor,
            {.doc = "temperature at the start over that for tracking; falls to it in three steps",
             .unit = "1",
             .min = 1.0});
    v.field("roughening", c.roughening,
            {.doc = "spread added to the poses at the start over their mean distance from each "
                    "other, falling to 0 over the first half of these scans",
             .unit = "1",
             .min = 0.0});
  }
};

struct LocalizerConfig {
  int particles = 1000;
  bool adaptive = true;
  double resample_below = 0.5;
  MotionModelConfig motion;
  GatingConfig gating;
  KldConfig kld;
  GlobalStartConfig global_start;
  PlaceFinderConfig global_search;
  RecoveryConfig recovery;
  BeyondMapConfig beyond_map;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("particles", c.particles,
            {.doc = "at the start, and always when adaptive is off",
             .unit = "particles",
             .min = 1,
             .when = "with adaptive off, or to make starts at a known pose cheaper or surer"});
    v.field("adaptive", c.adaptive, {.doc = "let the number of particles follow the posterior"});
    v.field("resample_below", c.resample_below,
            {.doc = "resample when the effective share of particles falls below",
             .min = 0.0,
             .max = 1.0});
    v.group("motion", c.motion, "noise of the odometry");
    v.group("gating", c.gating, "which scans are weighed");
    v.group("kld", c.kld, "how many particles the posterior needs");
    v.group("global_start", c.global_start,
            "start without a pose, where global_search is not used");
    v.group("global_search", c.global_search, "the search for the robot in the whole map");
    v.group("recovery", c.recovery, "health and recovery");
    v.group("beyond_map", c.beyond_map, "going on where the map ends");
  }
};

}  // namespace strata::localization
