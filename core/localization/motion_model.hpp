// SPDX-License-Identifier: Apache-2.0
/// Odometry as rotation, translation, rotation, with noise that grows with each.
#pragma once

#include <cstdint>

#include "core/base/parallel.hpp"
#include "core/geometry/pose2.hpp"
#include "core/localization/particle_set.hpp"

namespace strata::localization {

/// Variances per squared motion [thrun2005probabilistic, table 5.6, with the squares that its text
/// asks for], plus a floor that keeps particles apart when the odometry says that nothing moved.
struct MotionModelConfig {
  double rotation_from_rotation = 0.05;        ///< alpha 1
  double rotation_from_translation = 0.02;     ///< alpha 2, rad^2 per m^2
  double translation_from_translation = 0.05;  ///< alpha 3
  double translation_from_rotation = 0.02;     ///< alpha 4, m^2 per rad^2
  double floor_translation_m = 0.005;
  double floor_rotation_rad = 0.0035;
  double blind_translation_m = 0.10;
  double blind_rotation_rad = 0.10;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("rotation_from_rotation", c.rotation_from_rotation,
            {.doc = "variance of a rotation per squared rotation",
             .unit = "1",
             .min = 0.0,
             .when = "wheels slip when the robot turns: raise it"});
    v.field("rotation_from_translation", c.rotation_from_translation,
            {.doc = "variance of a rotation per squared translation",
             .unit = "rad^2/m^2",
             .min = 0.0,
             .when = "the robot drifts to one side when driving straight: raise it"});
    v.field("translation_from_translation", c.translation_from_translation,
            {.doc = "variance of a translation per squared translation",
             .unit = "1",
             .min = 0.0,
             .when = "the odometry measures distances badly: raise it"});
    v.field("translation_from_rotation", c.translation_from_rotation,
            {.doc = "variance of a translation per squared rotation",
             .unit = "m^2/rad^2",
             .min = 0.0,
             .when = "the robot is displaced when it turns: raise it"});
    v.field("floor_translation_m", c.floor_translation_m,
            {.doc = "least spread per weighed scan, along and across", .unit = "m", .min = 0.0});
    v.field("floor_rotation_rad", c.floor_rotation_rad,
            {.doc = "least spread of the heading per weighed scan", .unit = "rad", .min = 0.0});
    v.field("blind_translation_m", c.blind_translation_m,
            {.doc = "spread per weighed scan when there is no odometry", .unit = "m", .min = 0.0});
    v.field("blind_rotation_rad", c.blind_rotation_rad,
            {.doc = "the same for the heading", .unit = "rad", .min = 0.0});
  }
};

/// A motion decomposed: turn, go straight, turn.
struct MotionParts {
  double rotation1_rad = 0.0;
  double translation_m = 0.0;
  double rotation2_rad = 0.0;
};
[[nodiscard]] MotionParts decompose(const Pose2& before_from_after);

/// Standard deviations that go with a motion. A turn of nearly pi before a step back counts as a
/// small one, as driving backwards does not turn the robot; the direction of a step below 1 cm
/// counts as noise of the odometry, not as a turn.
struct MotionSpread {
  double rotation1_rad = 0.0;
  double translation_m = 0.0;
  double rotation2_rad = 0.0;
  double across_m = 0.0;
};
[[nodiscard]] MotionSpread motion_spread(const MotionParts& parts, const MotionModelConfig& config,
                                         bool has_odometry = true);

/// x_i <- x_i * motion, for every particle, without noise.
void move_particles(const Pose2& before_from_after, ParticleSet& particles, WorkerPool& pool);

/// x_i <- x_i * inverse(already_moved) * sample(motion): particles that were moved by
/// `already_moved` without noise since the last draw get the noise of the whole motion at once. So
/// the noise depends on how far the robot went between two weighed scans, not on how many scans lay
/// in between. sample(motion): rotation1 + noise, (translation + noise, noise across), rotation2 +
/// noise. Particle i draws from (seed, kMotion, step, i), as motion_kernel.hpp says.
void sample_motions(const Pose2& motion, const Pose2& already_moved, bool has_odometry,
                    const MotionModelConfig& config, std::uint64_t seed, std::uint64_t step,
                    ParticleSet& particles, WorkerPool& pool);

}  // namespace strata::localization
