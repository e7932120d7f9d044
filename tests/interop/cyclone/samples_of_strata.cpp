// SPDX-License-Identifier: Apache-2.0
/// The samples of our own types.
#include <cstdint>
#include <string>

#include "tests/interop/cyclone/sample_header.hpp"
#include "tests/interop/cyclone/samples.hpp"

namespace strata::test {
namespace {

strata_msgs::msg::Pose2 pose2(double start) {
  strata_msgs::msg::Pose2 result;
  result.x(start);
  result.y(-start);
  result.theta(start / 7.0);
  return result;
}

strata_msgs::msg::CellRect rect() {
  strata_msgs::msg::CellRect result;
  result.min_x(-3);
  result.min_y(2);
  result.max_x(-1);
  result.max_y(5);
  return result;
}

strata_msgs::msg::ReflectionGrid grid() {
  strata_msgs::msg::ReflectionGrid result;
  result.resolution(0.05);
  result.rect(rect());
  result.reflection({0.5F, 1.0F, 0.0F, 0.25F, 0.125F, 1.0F / 3.0F});
  return result;
}

strata_msgs::msg::TopicCount count(const std::string& topic, std::uint64_t number) {
  strata_msgs::msg::TopicCount result;
  result.topic(topic);
  result.count(number);
  return result;
}

}  // namespace

template <>
strata_msgs::msg::Ack sample() {
  strata_msgs::msg::Ack result;
  result.sequence_number(1ULL << 33U);
  result.component_name("/localizer");
  result.ok(true);
  result.error("none");
  result.published({count("/tf", 3), count("/amcl_pose", 1ULL << 40U)});
  return result;
}

template <>
strata_msgs::msg::ScanPose sample() {
  strata_msgs::msg::ScanPose result;
  result.header(header("map"));
  result.run(2);
  result.index(77);
  result.map_from_robot().mean(pose2(2.0));
  result.map_from_robot().covariance()[8] = 1e-9;
  result.odom_from_robot(pose2(5.0));
  result.has_odometry(true);
  return result;
}

template <>
strata_msgs::msg::LabeledScan sample() {
  strata_msgs::msg::LabeledScan result;
  result.pose(sample<strata_msgs::msg::ScanPose>());
  result.scan(sample<sensor_msgs::msg::LaserScan>());
  result.robot_from_laser(pose2(0.3));
  result.static_probability({0.0F, 0.5F, 1.0F});
  return result;
}

template <>
strata_msgs::msg::LocalizationHealth sample() {
  strata_msgs::msg::LocalizationHealth result;
  result.header(header("map"));
  result.model("patch");
  result.localized(true);
  result.particles(1000);
  result.effective_sample_size(512.5);
  result.log_likelihood_per_beam(-2.5);
  return result;
}

template <>
strata_msgs::msg::NodeMap sample() {
  strata_msgs::msg::NodeLevel level;
  level.name("short");
  level.half_life_s(60.0);
  level.consistent(true);
  level.ranges({1.0F, 2.0F, 3.0F});
  strata_msgs::msg::MemoryNode node;
  node.id(4);
  node.pose(pose2(1.0));
  node.observations(9);
  node.levels({level, {}, level});
  strata_msgs::msg::NodeMap result;
  result.header(header("map"));
  result.radius(8.0);
  result.nodes({node, {}, node});
  return result;
}

template <>
strata_msgs::msg::PatchMap sample() {
  strata_msgs::msg::Configuration configuration;
  configuration.reflection(grid());
  configuration.counts().resolution(0.05);
  configuration.counts().rect(rect());
  configuration.counts().hits({1.0, 0.5});
  configuration.counts().misses({0.0, 2.5});
  configuration.prior(0.75);
  strata_msgs::msg::ObservationSequence sequence;
  sequence.run(1);
  sequence.begin().sec(10);
  sequence.end().sec(20);
  sequence.scans(30);
  sequence.membership({0.25, 0.75});
  strata_msgs::msg::Submap submap;
  submap.id(6);
  submap.rect(rect());
  submap.contradictory({1, 0, 1});
  submap.configurations({configuration, configuration});
  submap.sequences({sequence, sequence, sequence});
  strata_msgs::msg::PatchMap result;
  result.header(header("map"));
  result.base(grid());
  result.submaps({submap, {}, submap});
  return result;
}

template <>
strata_msgs::msg::ReflectionGrid sample() {
  return grid();
}

template <>
strata_msgs::msg::Step sample() {
  strata_msgs::msg::Step result;
  result.sequence_number(5);
  result.kind(strata_msgs::msg::STEP_CYCLE);
  result.target("/a/b");
  result.out_dir("out");
  result.expected({count("/scan", 1)});
  result.readers({count("", 0), count("/x", 2)});
  return result;
}

template <>
strata_msgs::msg::SubmapStates sample() {
  strata_msgs::msg::SubmapState state;
  state.submap(3);
  state.probability({0.1, 0.2, 0.7});
  strata_msgs::msg::SubmapStates result;
  result.header(header("map"));
  result.current(-1);
  result.states({state, {}, state});
  return result;
}

template <>
strata_msgs::msg::Topologies sample() {
  strata_msgs::msg::Pose2Gaussian landmark;
  landmark.mean(pose2(1.5));
  landmark.covariance()[4] = 0.01;
  strata_msgs::msg::Topology topology;
  topology.probability(2.0 / 3.0);
  topology.log_evidence(-12.5);
  topology.labels({0, 1, 0});
  topology.landmarks({landmark, landmark});
  strata_msgs::msg::Topologies result;
  result.header(header("map"));
  result.visits().resize(3);
  result.visits()[2].sec(9);
  result.topologies({topology, {}, topology});
  return result;
}

template <>
strata_msgs::msg::Trajectory sample() {
  strata_msgs::msg::ScanLabels labels;
  labels.static_probability({0.5F, 0.25F});
  strata_msgs::msg::Trajectory result;
  result.header(header("map"));
  result.run({0, 1});
  result.stamps().resize(2);
  result.stamps()[1].sec(4);
  result.map_from_robot({pose2(1.0), pose2(2.0)});
  result.labels({labels, {}});
  return result;
}

}  // namespace strata::test
