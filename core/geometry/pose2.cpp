// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/pose2.hpp"

#include <cmath>
#include <cstddef>

#include "core/geometry/angle.hpp"

namespace strata {

Pose2 operator*(const Pose2& a_from_b, const Pose2& b_from_c) {
  const double c = std::cos(a_from_b.theta);
  const double s = std::sin(a_from_b.theta);
  return {a_from_b.x + c * b_from_c.x - s * b_from_c.y,
          a_from_b.y + s * b_from_c.x + c * b_from_c.y,
          wrap_angle(a_from_b.theta + b_from_c.theta)};
}

Eigen::Vector2d operator*(const Pose2& a_from_b, const Eigen::Vector2d& point_in_b) {
  const double c = std::cos(a_from_b.theta);
  const double s = std::sin(a_from_b.theta);
  return {a_from_b.x + c * point_in_b.x() - s * point_in_b.y(),
          a_from_b.y + s * point_in_b.x() + c * point_in_b.y()};
}

Pose2 inverse(const Pose2& a_from_b) {
  const double c = std::cos(a_from_b.theta);
  const double s = std::sin(a_from_b.theta);
  return {-c * a_from_b.x - s * a_from_b.y, s * a_from_b.x - c * a_from_b.y,
          wrap_angle(-a_from_b.theta)};
}

Pose2 between(const Pose2& a_from_b, const Pose2& a_from_c) {
  const double c = std::cos(a_from_b.theta);
  const double s = std::sin(a_from_b.theta);
  const double dx = a_from_c.x - a_from_b.x;
  const double dy = a_from_c.y - a_from_b.y;
  return {c * dx + s * dy, -s * dx + c * dy, wrap_angle(a_from_c.theta - a_from_b.theta)};
}

double translation_distance(const Pose2& a, const Pose2& b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}

bool has_moved(const Pose2& a, const Pose2& b, double distance_m, double turn_rad) {
  return translation_distance(a, b) >= distance_m ||
         std::abs(angle_difference(b.theta, a.theta)) >= turn_rad;
}

double displacement_m(const Pose2& a, const Pose2& b, double lever_m) {
  return translation_distance(a, b) + lever_m * std::abs(angle_difference(b.theta, a.theta));
}

bool is_finite(const Pose2& pose) {
  return std::isfinite(pose.x) && std::isfinite(pose.y) && std::isfinite(pose.theta);
}

Eigen::Matrix3d compose_jacobian_left(const Pose2& a_from_b, const Pose2& b_from_c) {
  const double c = std::cos(a_from_b.theta);
  const double s = std::sin(a_from_b.theta);
  Eigen::Matrix3d jacobian = Eigen::Matrix3d::Identity();
  jacobian(0, 2) = -s * b_from_c.x - c * b_from_c.y;
  jacobian(1, 2) = c * b_from_c.x - s * b_from_c.y;
  return jacobian;
}

Eigen::Matrix3d compose_jacobian_right(const Pose2& a_from_b, const Pose2& /*b_from_c*/) {
  const double c = std::cos(a_from_b.theta);
  const double s = std::sin(a_from_b.theta);
  Eigen::Matrix3d jacobian = Eigen::Matrix3d::Identity();
  jacobian(0, 0) = c;
  jacobian(0, 1) = -s;
  jacobian(1, 0) = s;
  jacobian(1, 1) = c;
  return jacobian;
}

Pose2 interpolate(const Pose2& a, const Pose2& b, double t) {
  return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y),
          wrap_angle(a.theta + t * angle_difference(b.theta, a.theta))};
}

Pose2 align(std::span<const Pose2> source, std::span<const Pose2> target) {
  const auto n = static_cast<double>(source.size());
  Eigen::Vector2d source_mean = Eigen::Vector2d::Zero();
  Eigen::Vector2d target_mean = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < source.size(); ++i) {
    source_mean += source[i].translation() / n;
    target_mean += target[i].translation() / n;
  }
  double dot = 0.0;
  double cross = 0.0;
  for (std::size_t i = 0; i < source.size(); ++i) {
    const Eigen::Vector2d s = source[i].translation() - source_mean;
    const Eigen::Vector2d t = target[i].translation() - target_mean;
    dot += s.dot(t);
    cross += s.x() * t.y() - s.y() * t.x();
  }
  const bool degenerate = std::hypot(dot, cross) < 1e-12;
  const double theta =
      degenerate ? angle_difference(target[0].theta, source[0].theta) : std::atan2(cross, dot);
  const Eigen::Vector2d rotated = Pose2{0.0, 0.0, theta} * source_mean;
  return {target_mean.x() - rotated.x(), target_mean.y() - rotated.y(), theta};
}

}  // namespace strata
