// SPDX-License-Identifier: Apache-2.0
#include "core/localization/motion_model.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "core/geometry/angle.hpp"
#include "core/random/stream.hpp"

namespace strata::localization {
namespace {

TEST(MotionModel, WithoutNoiseIsTheMotionItself) {
  RandomStream random(3, StreamId::kTest);
  const MotionModelConfig noiseless{0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  WorkerPool pool(1);
  for (int n = 0; n < 200; ++n) {
    const Pose2 motion{random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0),
                       random.uniform(-3.0, 3.0)};
    ParticleSet particles;
    particles.resize(9);
    sample_motions(motion, Pose2{}, true, noiseless, 1, 1, particles, pool);
    for (std::size_t i = 0; i < particles.size(); ++i) {
      EXPECT_NEAR(particles.x_m[i], motion.x, 1e-12);
      EXPECT_NEAR(particles.y_m[i], motion.y, 1e-12);
      EXPECT_NEAR(angle_difference(particles.theta_rad[i], motion.theta), 0.0, 1e-12);
    }
  }
}

TEST(MotionModel, MomentsAreThoseOfTheClosedForm) {
  const MotionModelConfig config;
  const MotionParts parts = decompose({0.8, 0.3, 0.5});
  const MotionSpread spread = motion_spread(parts, config);
  const double expected_r1 = config.rotation_from_rotation * std::pow(std::atan2(0.3, 0.8), 2) +
                             config.rotation_from_translation * (0.64 + 0.09);
  EXPECT_NEAR(spread.rotation1_rad * spread.rotation1_rad, expected_r1, 1e-12);
  // x = along cos r1 - across sin r1, with independent normals: E cos(m + sN) = cos(m) e^{-s^2/2}.
  const double damp = std::exp(-0.5 * spread.rotation1_rad * spread.rotation1_rad);
  const double damp4 = std::pow(damp, 4);
  const double m = parts.rotation1_rad;
  const double along2 =
      parts.translation_m * parts.translation_m + spread.translation_m * spread.translation_m;
  const double across2 = spread.across_m * spread.across_m;
  const double mean_x = parts.translation_m * std::cos(m) * damp;
  const double second_x = along2 * 0.5 * (1.0 + std::cos(2.0 * m) * damp4) +
                          across2 * 0.5 * (1.0 - std::cos(2.0 * m) * damp4);
  const double var_theta =
      spread.rotation1_rad * spread.rotation1_rad + spread.rotation2_rad * spread.rotation2_rad;
  const int n = 200000;
  double sum_x = 0.0;
  double sum_xx = 0.0;
  double sum_tt = 0.0;
  ParticleSet particles;
  particles.resize(static_cast<std::size_t>(n));
  WorkerPool pool(1);
  sample_motions({0.8, 0.3, 0.5}, Pose2{}, true, config, 5, 1, particles, pool);
  for (int i = 0; i < n; ++i) {
    const Pose2 p = particles.pose(static_cast<std::size_t>(i));
    sum_x += p.x;
    sum_xx += p.x * p.x;
    sum_tt += std::pow(angle_difference(p.theta, 0.5), 2);
  }
  const double standard_error = std::sqrt((second_x - mean_x * mean_x) / n);
  EXPECT_NEAR(sum_x / n, mean_x, 4.0 * standard_error);
  EXPECT_NEAR(sum_xx / n, second_x, 0.01 * second_x);
  EXPECT_NEAR(sum_tt / n, var_theta, 0.02 * var_theta);
}

TEST(MotionModel, DrivingBackwardsIsNoTurn) {
  const MotionModelConfig config;
  const MotionSpread forward = motion_spread(decompose({0.5, 0.0, 0.0}), config);
  const MotionSpread backward = motion_spread(decompose({-0.5, 0.0, 0.0}), config);
  EXPECT_NEAR(forward.rotation1_rad, backward.rotation1_rad, 1e-12);
  EXPECT_NEAR(forward.rotation2_rad, backward.rotation2_rad, 1e-12);
}

TEST(MotionModel, NoiseDoesNotDependOnTheScansInBetween) {
  ParticleSet direct;
  direct.resize(50);
  ParticleSet pieces = direct;
  WorkerPool pool(1);
  const Pose2 part{0.1, 0.02, 0.1};
  const Pose2 whole = part * part * part;
  move_particles(part, pieces, pool);
  move_particles(part, pieces, pool);
  sample_motions(whole, part * part, true, {}, 7, 1, pieces, pool);
  sample_motions(whole, Pose2{}, true, {}, 7, 1, direct, pool);
  for (std::size_t i = 0; i < direct.size(); ++i) {
    EXPECT_NEAR(direct.x_m[i], pieces.x_m[i], 1e-12);
    EXPECT_NEAR(direct.y_m[i], pieces.y_m[i], 1e-12);
    EXPECT_NEAR(direct.theta_rad[i], pieces.theta_rad[i], 1e-12);
  }
}

}  // namespace
}  // namespace strata::localization
