// SPDX-License-Identifier: Apache-2.0
#include "core/localization/motion_model.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "core/geometry/angle.hpp"
#include "core/localization/motion_kernel.hpp"
#include "core/random/stream_key.hpp"

namespace strata::localization {
namespace {

constexpr std::size_t kMovedAtOnce = 256;
constexpr double kShortestStep_m = 0.01;

double square(double x) { return x * x; }

/// How much a rotation counts for noise: driving backwards is not a turn of pi.
double turning(double rotation_rad) {
  const double size = std::abs(rotation_rad);
  return std::min(size, std::numbers::pi - size);
}

}  // namespace

MotionParts decompose(const Pose2& before_from_after) {
  MotionParts parts;
  parts.translation_m = std::hypot(before_from_after.x, before_from_after.y);
  if (parts.translation_m > 0.0) {
    parts.rotation1_rad = std::atan2(before_from_after.y, before_from_after.x);
  }
  parts.rotation2_rad = angle_difference(before_from_after.theta, parts.rotation1_rad);
  return parts;
}

MotionSpread motion_spread(const MotionParts& parts, const MotionModelConfig& config,
                           bool has_odometry) {
  const double t2 = square(parts.translation_m);
  // The direction of a very short step is noise of the odometry and no turn of the robot.
  const bool is_short = parts.translation_m < kShortestStep_m;
  const double whole = std::abs(wrap_angle(parts.rotation1_rad + parts.rotation2_rad));
  const double r1 = is_short ? 0.0 : square(turning(parts.rotation1_rad));
  const double r2 = square(is_short ? whole : turning(parts.rotation2_rad));
  const double blind_t = has_odometry ? 0.0 : square(config.blind_translation_m);
  const double blind_r = has_odometry ? 0.0 : square(config.blind_rotation_rad);
  const double floor_t = square(config.floor_translation_m);
  MotionSpread spread;
  spread.rotation1_rad =
      std::sqrt(config.rotation_from_rotation * r1 + config.rotation_from_translation * t2);
  spread.translation_m =
      std::sqrt(config.translation_from_translation * t2 +
                config.translation_from_rotation * (r1 + r2) + floor_t + blind_t);
  spread.rotation2_rad =
      std::sqrt(config.rotation_from_rotation * r2 + config.rotation_from_translation * t2 +
                square(config.floor_rotation_rad) + blind_r);
  spread.across_m = std::sqrt(floor_t + blind_t);
  return spread;
}

void move_particles(const Pose2& before_from_after, ParticleSet& particles, WorkerPool& pool) {
  if (before_from_after == Pose2{}) return;
  const auto move = [&](std::size_t begin, std::size_t end, std::size_t /*chunk*/) {
    move_poses(before_from_after, {particles.x_m.data() + begin, particles.y_m.data() + begin,
                                   particles.theta_rad.data() + begin, end - begin});
  };
  pool.for_chunks(particles.size(), kMovedAtOnce, std::cref(move));
}

void sample_motions(const Pose2& motion, const Pose2& already_moved, bool has_odometry,
                    const MotionModelConfig& config, std::uint64_t seed, std::uint64_t step,
                    ParticleSet& particles, WorkerPool& pool) {
  const MotionParts parts = decompose(motion);
  const MotionSpread spread = motion_spread(parts, config, has_odometry);
  MotionDraw draw;
  if (!(already_moved == Pose2{})) draw.back = inverse(already_moved);
  draw.rotation1_rad = parts.rotation1_rad;
  draw.translation_m = parts.translation_m;
  draw.rotation2_rad = parts.rotation2_rad;
  draw.rotation1_stddev_rad = spread.rotation1_rad;
  draw.translation_stddev_m = spread.translation_m;
  draw.across_stddev_m = spread.across_m;
  draw.rotation2_stddev_rad = spread.rotation2_rad;
  draw.key = stream_key(seed, StreamId::kMotion);
  draw.step = step;
  const auto move = [&](std::size_t begin, std::size_t end, std::size_t /*chunk*/) {
    draw_motions(draw, begin,
                 {particles.x_m.data() + begin, particles.y_m.data() + begin,
                  particles.theta_rad.data() + begin, end - begin});
  };
  pool.for_chunks(particles.size(), kMovedAtOnce, std::cref(move));
}

}  // namespace strata::localization
