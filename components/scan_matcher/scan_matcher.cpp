// SPDX-License-Identifier: Apache-2.0
#include "components/scan_matcher/scan_matcher.hpp"

#include "components/convert/geometry_messages.hpp"
#include "components/convert/map_messages.hpp"
#include "components/convert/scan_messages.hpp"
#include "components/maps/maps_folder.hpp"

namespace strata::scan_matcher {

void ScanMatcher::on_configure() {
  config_ = read_parameters<ScanMatcherConfig>();
  keep_live(config_, {"publish_tf"});
  input_.emplace(config_.input, !lockstep());
  slam_ = std::make_unique<slam::Slam>(config_.slam, context().threads);
  publish_scan_pose_ = advertise<strata_msgs::msg::ScanPose>("scan_pose", "default");
  publish_posed_scan_ = advertise<strata_msgs::msg::LabeledScan>("posed_scan", "default");
  publish_mapped_scan_ = advertise<strata_msgs::msg::LabeledScan>("mapped_scan", "lossless");
  publish_filtered_ = advertise<strata_msgs::msg::ReflectionGrid>("reflection_filtered", "latched");
  publish_map_ = advertise<nav_msgs::msg::OccupancyGrid>("map", "latched");
  publish_tf_ = advertise<tf2_msgs::msg::TFMessage>("/tf", "tf");
  subscribe<tf2_msgs::msg::TFMessage>("/tf_static", "tf_static", [this](const auto& message) {
    input_->add(message);
    take_observations();
  });
  subscribe<nav_msgs::msg::Odometry>(config_.input.odometry_topic, config_.sensor_qos,
                                     [this](const auto& message) {
                                       input_->add(message);
                                       // In lockstep the scan comes after its odometry.
                                       if (!lockstep()) take_observations();
                                     });
  subscribe<sensor_msgs::msg::LaserScan>(config_.input.scan_topic, config_.sensor_qos,
                                         [this](const auto& message) {
                                           input_->add(message);
                                           take_observations();
                                         });
}

void ScanMatcher::take_observations() {
  for (const Observation& observation : input_->take()) {
    const Pose2Gaussian pose = slam_->add(observation);
    publish_pose(observation, pose);
    publish_posed_scan_(convert::to_message(
        PosedScan{observation.run, observation.scan, pose.mean, {}}, config_.map_frame, "laser"));
  }
}

void ScanMatcher::publish_pose(const Observation& observation, const Pose2Gaussian& pose) {
  strata_msgs::msg::ScanPose message;
  message.header(convert::make_header(observation.scan.stamp, config_.map_frame));
  message.run(observation.run);
  message.index(index_++);
  message.map_from_robot(convert::to_message(pose));
  message.odom_from_robot(convert::to_message(observation.odom_from_robot));
  message.has_odometry(observation.has_odometry);
  publish_scan_pose_(message);
  if (!config_.publish_tf || !observation.has_odometry) return;
  tf2_msgs::msg::TFMessage tf;
  tf.transforms().push_back(convert::to_transform_stamped(
      observation.scan.stamp, pose.mean * inverse(observation.odom_from_robot), config_.map_frame,
      config_.odometry_frame));
  publish_tf_(tf);
}

void ScanMatcher::on_finish(const std::filesystem::path& out_dir) {
  const slam::SlamResult result = slam_->finish(context().progress);
  publish_result(result);
  maps::write_grid_maps(out_dir, result);
}

void ScanMatcher::publish_result(const slam::SlamResult& result) {
  const Stamp stamp = result.scans.empty() ? Stamp() : result.scans.back().scan.stamp;
  for (const PosedScan& scan : result.scans) {
    publish_mapped_scan_(convert::to_message(scan, config_.map_frame, "laser"));
  }
  publish_filtered_(convert::to_message(result.filtered));
  publish_map_(convert::to_occupancy(result.occupancy, stamp, config_.map_frame));
}

void ScanMatcher::on_cleanup() {
  slam_.reset();
  index_ = 0;
}

}  // namespace strata::scan_matcher
