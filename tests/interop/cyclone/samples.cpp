// SPDX-License-Identifier: Apache-2.0
#include "tests/interop/cyclone/samples.hpp"

#include <limits>

#include "tests/interop/cyclone/sample_header.hpp"

namespace strata::test {
namespace {

geometry_msgs::msg::Pose pose(double start) {
  geometry_msgs::msg::Pose result;
  result.position().x(start);
  result.position().y(start + 0.25);
  result.position().z(-start);
  result.orientation().z(0.6);
  result.orientation().w(0.8);
  return result;
}

rcl_interfaces::msg::Parameter parameter() {
  rcl_interfaces::msg::Parameter result;
  result.name("localizer.motion.floor_m");
  result.value().type(3);
  result.value().double_value(0.005);
  result.value().string_array_value({"", "a", "abcd"});
  result.value().bool_array_value({true, false, true});
  result.value().integer_array_value({-1, 1LL << 40});
  return result;
}

}  // namespace

template <>
diagnostic_msgs::msg::DiagnosticArray sample() {
  diagnostic_msgs::msg::KeyValue value;
  value.key("processed");
  value.value("12");
  diagnostic_msgs::msg::DiagnosticStatus status;
  status.level(2);
  status.name("robot1/localizer: health");
  status.message("lost");
  status.hardware_id("strata");
  status.values({value, value});
  diagnostic_msgs::msg::DiagnosticArray result;
  result.header(header(""));
  result.status({status, {}, status});
  return result;
}

template <>
geometry_msgs::msg::PointStamped sample() {
  geometry_msgs::msg::PointStamped result;
  result.header(header("base_link"));
  result.point().x(0.25);
  result.point().z(-1.0);
  return result;
}

template <>
geometry_msgs::msg::PoseWithCovarianceStamped sample() {
  geometry_msgs::msg::PoseWithCovarianceStamped result;
  result.header(header("map"));
  result.pose().pose(pose(1.5));
  for (std::size_t i = 0; i < 36; ++i) result.pose().covariance()[i] = 0.1 * static_cast<double>(i);
  return result;
}

template <>
rcl_interfaces::msg::Log sample() {
  rcl_interfaces::msg::Log result;
  result.stamp(header("").stamp());
  result.level(40);
  result.name("robot1.localizer");
  result.msg("no odometry");
  result.file("f");
  result.line(7);
  return result;
}

template <>
lifecycle_msgs::msg::TransitionEvent sample() {
  lifecycle_msgs::msg::TransitionEvent result;
  result.timestamp(1ULL << 60U);
  result.transition().id(3);
  result.transition().label("activate");
  result.start_state().id(2);
  result.start_state().label("inactive");
  result.goal_state().id(3);
  result.goal_state().label("active");
  return result;
}

template <>
nav2_msgs::msg::CostmapFilterInfo sample() {
  nav2_msgs::msg::CostmapFilterInfo result;
  result.header(header("map"));
  result.type(1);
  result.filter_mask_topic("/change_mask");
  result.base(100.0F);
  result.multiplier(-0.7F);
  return result;
}

template <>
nav2_msgs::msg::ParticleCloud sample() {
  nav2_msgs::msg::ParticleCloud result;
  result.header(header("map"));
  for (int i = 0; i < 100; ++i) {
    nav2_msgs::msg::Particle particle;
    particle.pose(pose(i));
    particle.weight(0.01);
    result.particles().push_back(particle);
  }
  return result;
}

nav_msgs::msg::OccupancyGrid square_map(std::uint32_t side) {
  nav_msgs::msg::OccupancyGrid result;
  result.header(header("map"));
  result.info().resolution(0.05F);
  result.info().width(side);
  result.info().height(side);
  result.info().origin(pose(-10.0));
  result.data().resize(std::size_t{side} * side);
  for (std::size_t i = 0; i < result.data().size(); ++i) {
    result.data()[i] = static_cast<std::int8_t>(static_cast<int>(i * 7 % 102) - 1);
  }
  return result;
}

template <>
nav_msgs::msg::OccupancyGrid sample() {
  return square_map(13);
}

template <>
nav_msgs::msg::Odometry sample() {
  nav_msgs::msg::Odometry result;
  result.header(header("odom"));
  result.child_frame_id("base_link");
  result.pose().pose(pose(3.0));
  result.pose().covariance()[35] = 0.5;
  result.twist().twist().linear().x(0.4);
  result.twist().covariance()[0] = 0.25;
  return result;
}

template <>
std_msgs::msg::String sample() {
  std_msgs::msg::String result;
  result.data(R"({"places": [{"id": 1}, {"id": 22}]})");
  return result;
}

template <>
bond::msg::Status sample() {
  bond::msg::Status result;
  result.header(header(""));
  result.id("localizer");
  result.instance_id("0f9a");
  result.active(true);
  result.heartbeat_timeout(4.0F);
  result.heartbeat_period(0.1F);
  return result;
}

template <>
octomap_msgs::msg::Octomap sample() {
  octomap_msgs::msg::Octomap result;
  result.header(header("map"));
  result.binary(true);
  result.id("OcTree");
  result.resolution(0.1);
  result.data({1, -2, 3, -128, 127});
  return result;
}

template <>
rcl_interfaces::msg::ParameterEvent sample() {
  rcl_interfaces::msg::ParameterEvent result;
  result.stamp().sec(7);
  result.node("/robot1/localizer");
  result.changed_parameters({parameter(), parameter()});
  return result;
}

template <>
rosgraph_msgs::msg::Clock sample() {
  rosgraph_msgs::msg::Clock result;
  result.clock().sec(-3);
  result.clock().nanosec(999999999);
  return result;
}

template <>
sensor_msgs::msg::PointCloud2 sample() {
  sensor_msgs::msg::PointCloud2 result;
  result.header(header("lidar"));
  result.height(2);
  result.width(3);
  sensor_msgs::msg::PointField field;
  field.name("x");
  field.offset(4);
  field.datatype(7);
  field.count(1);
  result.fields({field, field});
  result.point_step(16);
  result.row_step(48);
  for (int i = 0; i < 96; ++i) result.data().push_back(static_cast<std::uint8_t>(3 * i));
  result.is_dense(true);
  return result;
}

template <>
sensor_msgs::msg::Image sample() {
  sensor_msgs::msg::Image result;
  result.header(header("camera_optical"));
  result.height(2);
  result.width(5);
  result.encoding("rgb8");
  result.is_bigendian(1);
  result.step(16);
  for (int i = 0; i < 32; ++i) result.data().push_back(static_cast<std::uint8_t>(7 * i));
  return result;
}

template <>
sensor_msgs::msg::CameraInfo sample() {
  sensor_msgs::msg::CameraInfo result;
  result.header(header("camera_optical"));
  result.height(480);
  result.width(640);
  result.distortion_model("plumb_bob");
  result.d({-0.3, 0.1, 1e-3, -2e-3, 0.01});
  for (std::size_t i = 0; i < 9; ++i) result.k()[i] = 100.5 + static_cast<double>(i);
  for (std::size_t i = 0; i < 9; ++i) result.r()[i] = 0.125 * static_cast<double>(i);
  for (std::size_t i = 0; i < 12; ++i) result.p()[i] = -3.25 * static_cast<double>(i);
  result.binning_x(2);
  result.binning_y(3);
  sensor_msgs::msg::RegionOfInterest roi;
  roi.x_offset(4);
  roi.y_offset(5);
  roi.height(6);
  roi.width(7);
  roi.do_rectify(true);
  result.roi(roi);
  return result;
}

template <>
sensor_msgs::msg::LaserScan sample() {
  sensor_msgs::msg::LaserScan result;
  result.header(header("laser_front"));
  result.angle_min(-1.5F);
  result.angle_max(1.5F);
  result.angle_increment(0.01F);
  result.time_increment(1e-4F);
  result.scan_time(0.1F);
  result.range_min(0.05F);
  result.range_max(30.0F);
  for (int i = 0; i < 301; ++i) result.ranges().push_back(0.1F * static_cast<float>(i));
  result.ranges()[5] = std::numeric_limits<float>::infinity();
  result.intensities({7.0F});
  return result;
}

template <>
tf2_msgs::msg::TFMessage sample() {
  tf2_msgs::msg::TFMessage result;
  for (const char* child : {"base_link", "laser", "a", ""}) {
    geometry_msgs::msg::TransformStamped transform;
    transform.header(header("odom"));
    transform.child_frame_id(child);
    transform.transform().translation().y(0.1);
    transform.transform().rotation().w(1.0);
    result.transforms().push_back(transform);
  }
  return result;
}

}  // namespace strata::test
