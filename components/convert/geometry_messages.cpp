// SPDX-License-Identifier: Apache-2.0
#include "components/convert/geometry_messages.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>

namespace strata::convert {
namespace {

constexpr std::int64_t kNsPerS = 1'000'000'000;

/// A value some units in the last place away.
double nudged(double value, int steps) {
  for (; steps > 0; --steps) value = std::nextafter(value, 2.0);
  for (; steps < 0; ++steps) value = std::nextafter(value, -2.0);
  return value;
}

/// The quaternion of a heading that reads back as the very same bits: of the few around the rounded
/// sine and cosine (they differ by 1e-16), the first that does. Without it a heading would drift
/// each time it travels, and replay over DDS would differ from the direct path.
Eigen::Quaterniond exact_rotation(double theta_rad) {
  const double z = std::sin(theta_rad / 2.0);
  const double w = std::cos(theta_rad / 2.0);
  constexpr int kReach = 4;
  for (int ring = 0; ring <= kReach; ++ring) {
    for (int dz = -ring; dz <= ring; ++dz) {
      for (int dw = -ring; dw <= ring; ++dw) {
        if (std::max(std::abs(dz), std::abs(dw)) != ring) continue;
        const Eigen::Quaterniond candidate(nudged(w, dw), 0.0, 0.0, nudged(z, dz));
        if (heading_of(candidate) == theta_rad) return candidate;
      }
    }
  }
  return {w, 0.0, 0.0, z};
}

template <typename Quaternion>
Quaternion to_quaternion(double theta_rad) {
  const Eigen::Quaterniond exact = exact_rotation(theta_rad);
  Quaternion q;
  q.x(0.0);
  q.y(0.0);
  q.z(exact.z());
  q.w(exact.w());
  return q;
}

template <typename Vector, typename Quaternion>
void put(const Pose2& pose, Vector& translation, Quaternion& rotation) {
  translation.x(pose.x);
  translation.y(pose.y);
  rotation = to_quaternion<Quaternion>(pose.theta);
}

template <typename Vector, typename Quaternion>
Pose3 make_pose3(const Vector& t, const Quaternion& q) {
  Pose3 pose;
  pose.translation = {t.x(), t.y(), t.z()};
  pose.rotation = Eigen::Quaterniond(q.w(), q.x(), q.y(), q.z());
  // All zero is what an unset rotation looks like.
  const double norm = pose.rotation.norm();
  if (norm == 0.0) pose.rotation.setIdentity();
  // One that is unit but for rounding keeps its bits; what is not one would stretch what it turns.
  if (std::isfinite(norm) && norm > 0.0 && std::abs(norm - 1.0) > 1e-3) pose.rotation.normalize();
  return pose;
}

/// Rows of the plane's (x, y, theta) in ROS's (x, y, z, roll, pitch, yaw).
constexpr std::array<std::size_t, 3> kPlanar = {0, 1, 5};

}  // namespace

builtin_interfaces::msg::Time to_message(Stamp stamp) {
  std::int64_t seconds = stamp.ns / kNsPerS;
  std::int64_t rest = stamp.ns % kNsPerS;
  if (rest < 0) {
    rest += kNsPerS;
    --seconds;
  }
  builtin_interfaces::msg::Time time;
  time.sec(static_cast<std::int32_t>(seconds));
  time.nanosec(static_cast<std::uint32_t>(rest));
  return time;
}

Stamp from_message(const builtin_interfaces::msg::Time& time) {
  return {static_cast<std::int64_t>(time.sec()) * kNsPerS +
          static_cast<std::int64_t>(time.nanosec())};
}

std_msgs::msg::Header make_header(Stamp stamp, const std::string& frame) {
  std_msgs::msg::Header header;
  header.stamp(to_message(stamp));
  header.frame_id(frame);
  return header;
}

geometry_msgs::msg::Pose to_pose(const Pose2& pose) {
  geometry_msgs::msg::Pose message;
  put(pose, message.position(), message.orientation());
  return message;
}

geometry_msgs::msg::Transform to_transform(const Pose2& pose) {
  geometry_msgs::msg::Transform message;
  put(pose, message.translation(), message.rotation());
  return message;
}

geometry_msgs::msg::Transform to_transform(const Pose3& pose) {
  geometry_msgs::msg::Transform message;
  message.translation().x(pose.translation.x());
  message.translation().y(pose.translation.y());
  message.translation().z(pose.translation.z());
  message.rotation().x(pose.rotation.x());
  message.rotation().y(pose.rotation.y());
  message.rotation().z(pose.rotation.z());
  message.rotation().w(pose.rotation.w());
  return message;
}

Pose3 from_message(const geometry_msgs::msg::Pose& pose) {
  return make_pose3(pose.position(), pose.orientation());
}

Pose3 from_message(const geometry_msgs::msg::Transform& transform) {
  return make_pose3(transform.translation(), transform.rotation());
}

strata_msgs::msg::Pose2 to_message(const Pose2& pose) {
  strata_msgs::msg::Pose2 message;
  message.x(pose.x);
  message.y(pose.y);
  message.theta(pose.theta);
  return message;
}

Pose2 from_message(const strata_msgs::msg::Pose2& pose) {
  return {pose.x(), pose.y(), pose.theta()};
}

strata_msgs::msg::Pose2Gaussian to_message(const Pose2Gaussian& gaussian) {
  strata_msgs::msg::Pose2Gaussian message;
  message.mean(to_message(gaussian.mean));
  for (int i = 0; i < 9; ++i) {
    message.covariance()[static_cast<std::size_t>(i)] = gaussian.covariance(i / 3, i % 3);
  }
  return message;
}

Pose2Gaussian from_message(const strata_msgs::msg::Pose2Gaussian& gaussian) {
  Pose2Gaussian value;
  value.mean = from_message(gaussian.mean());
  for (int i = 0; i < 9; ++i) {
    value.covariance(i / 3, i % 3) = gaussian.covariance()[static_cast<std::size_t>(i)];
  }
  return value;
}

geometry_msgs::msg::PoseWithCovariance to_pose_with_covariance(const Pose2Gaussian& gaussian) {
  geometry_msgs::msg::PoseWithCovariance message;
  message.pose(to_pose(gaussian.mean));
  message.covariance().fill(0.0);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      message.covariance()[6 * kPlanar[i] + kPlanar[j]] =
          gaussian.covariance(static_cast<int>(i), static_cast<int>(j));
    }
  }
  return message;
}

Pose2Gaussian from_message(const geometry_msgs::msg::PoseWithCovariance& pose) {
  Pose2Gaussian value;
  value.mean = planar(from_message(pose.pose()));
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      value.covariance(static_cast<int>(i), static_cast<int>(j)) =
          pose.covariance()[6 * kPlanar[i] + kPlanar[j]];
    }
  }
  return value;
}

nav_msgs::msg::Odometry to_odometry(Stamp stamp, const Pose2& odom_from_robot,
                                    const std::string& odom_frame, const std::string& robot_frame) {
  nav_msgs::msg::Odometry message;
  message.header(make_header(stamp, odom_frame));
  message.child_frame_id(robot_frame);
  message.pose().pose(to_pose(odom_from_robot));
  message.pose().covariance().fill(0.0);
  message.twist().covariance().fill(0.0);
  return message;
}

namespace {

template <typename Pose>
geometry_msgs::msg::TransformStamped stamped(Stamp stamp, const Pose& parent_from_child,
                                             const std::string& parent, const std::string& child) {
  geometry_msgs::msg::TransformStamped message;
  message.header(make_header(stamp, parent));
  message.child_frame_id(child);
  message.transform(to_transform(parent_from_child));
  return message;
}

}  // namespace

geometry_msgs::msg::TransformStamped to_transform_stamped(Stamp stamp,
                                                          const Pose2& parent_from_child,
                                                          const std::string& parent,
                                                          const std::string& child) {
  return stamped(stamp, parent_from_child, parent, child);
}
geometry_msgs::msg::TransformStamped to_transform_stamped(Stamp stamp,
                                                          const Pose3& parent_from_child,
                                                          const std::string& parent,
                                                          const std::string& child) {
  return stamped(stamp, parent_from_child, parent, child);
}

}  // namespace strata::convert
