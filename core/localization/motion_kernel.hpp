// SPDX-License-Identifier: Apache-2.0
/// Drawing the motion of every particle, with the widest SIMD that the machine has.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/geometry/pose2.hpp"
#include "core/localization/particle_kernels.hpp"

namespace strata::localization {

/// What every particle of a step draws its motion from.
struct MotionDraw {
  Pose2 back;  ///< composed to the right of every pose first
  double rotation1_rad = 0.0;
  double translation_m = 0.0;
  double rotation2_rad = 0.0;
  double rotation1_stddev_rad = 0.0;
  double translation_stddev_m = 0.0;
  double across_stddev_m = 0.0;
  double rotation2_stddev_rad = 0.0;
  std::array<std::uint32_t, 2> key{};  ///< of the random stream
  std::uint64_t step = 0;
};

/// pose_i <- pose_i * back * (turn, straight, turn, each with its noise) for particles first,
/// first + 1, ... Particle i draws one Philox block (0, i, step): words 0 and 1 give the normals of
/// rotation1 and translation, words 2 and 3 those across and of rotation2, by Box and Muller from
/// uniforms (w + 1/2) / 2^32 for the radius and w / 2^32 for the angle; none is above 6.8.
/// Requires |theta| < 1e4. O(count).
void draw_motions(const MotionDraw& draw, std::size_t first, const PoseColumns& poses);

/// pose_i <- pose_i * before_from_after. Requires |theta| < 1e4. O(count).
void move_poses(const Pose2& before_from_after, const PoseColumns& poses);

}  // namespace strata::localization
