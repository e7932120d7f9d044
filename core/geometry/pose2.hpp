// SPDX-License-Identifier: Apache-2.0
/// Rigid motions of the plane, SE(2). `a_from_b` maps coordinates in b to coordinates in a, so
/// `map_from_laser = map_from_robot * robot_from_laser` reads correctly or fails visibly.
#pragma once

#include <span>

#include <Eigen/Core>

namespace strata {

/// Position and heading: metres and radians, theta in (-pi, pi] after every operation here.
struct Pose2 {
  double x = 0.0;
  double y = 0.0;
  double theta = 0.0;

  friend bool operator==(const Pose2&, const Pose2&) = default;
  [[nodiscard]] Eigen::Vector2d translation() const { return {x, y}; }
  [[nodiscard]] Eigen::Vector3d vector() const { return {x, y, theta}; }
};

/// a_from_c = a_from_b * b_from_c.
[[nodiscard]] Pose2 operator*(const Pose2& a_from_b, const Pose2& b_from_c);
/// The point of frame b in frame a.
[[nodiscard]] Eigen::Vector2d operator*(const Pose2& a_from_b, const Eigen::Vector2d& point_in_b);
/// b_from_a.
[[nodiscard]] Pose2 inverse(const Pose2& a_from_b);
/// b_from_c, given both in a: inverse(a_from_b) * a_from_c.
[[nodiscard]] Pose2 between(const Pose2& a_from_b, const Pose2& a_from_c);
/// Distance of the two origins in metres.
[[nodiscard]] double translation_distance(const Pose2& a, const Pose2& b);
/// Whether b lies at least distance_m from a, or is turned by at least turn_rad: far enough for a
/// scan from there to tell something new.
[[nodiscard]] bool has_moved(const Pose2& a, const Pose2& b, double distance_m, double turn_rad);
/// How far what is seen `lever_m` away moves at most when it is seen from b and not from a, in
/// metres.
[[nodiscard]] double displacement_m(const Pose2& a, const Pose2& b, double lever_m);
/// Whether all three numbers are finite.
[[nodiscard]] bool is_finite(const Pose2& pose);

/// Jacobian of (a_from_b * b_from_c) as a vector (x, y, theta) with respect to a_from_b.
[[nodiscard]] Eigen::Matrix3d compose_jacobian_left(const Pose2& a_from_b, const Pose2& b_from_c);
/// ... with respect to b_from_c.
[[nodiscard]] Eigen::Matrix3d compose_jacobian_right(const Pose2& a_from_b, const Pose2& b_from_c);

/// The pose at fraction t in [0, 1] from a to b: translation linear, heading the short way round.
[[nodiscard]] Pose2 interpolate(const Pose2& a, const Pose2& b, double t);

/// The rigid motion (no scale) that minimizes the squared distance of target_i to motion * source_i
/// [horn1987closed], from positions only. With fewer than two distinct points the heading is taken
/// from the first pair of poses. Requires equal lengths of at least one.
[[nodiscard]] Pose2 align(std::span<const Pose2> source, std::span<const Pose2> target);

}  // namespace strata
