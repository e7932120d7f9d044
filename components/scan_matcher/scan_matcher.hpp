// SPDX-License-Identifier: Apache-2.0
/// strata::ScanMatcher: scans and odometry in; the pose of each scan out, and at the end of a log
/// everything slam::Slam::finish makes.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "components/runtime/component.hpp"
#include "components/runtime/sensor_input.hpp"
#include "components/scan_matcher/config.hpp"
#include "core/slam/slam.hpp"

namespace strata::scan_matcher {

/// Out: scan_pose (ScanPose), posed_scan (LabeledScan without labels), /tf. After finish:
/// mapped_scan (LabeledScan with final poses and labels, one a scan), reflection_filtered, map and
/// map_filtered; and the grid maps and the trajectory in MAPS.
class ScanMatcher final : public runtime::Component {
 public:
  using Component::Component;

 private:
  void on_configure() override;
  void on_cleanup() override;
  void on_finish(const std::filesystem::path& out_dir) override;
  void take_observations();
  void publish_pose(const Observation& observation, const Pose2Gaussian& pose);
  void publish_result(const slam::SlamResult& result);

  ScanMatcherConfig config_;
  std::optional<runtime::SensorInput> input_;
  std::unique_ptr<slam::Slam> slam_;
  std::uint64_t index_ = 0;
  std::function<void(const strata_msgs::msg::ScanPose&)> publish_scan_pose_;
  std::function<void(const strata_msgs::msg::LabeledScan&)> publish_posed_scan_;
  std::function<void(const strata_msgs::msg::LabeledScan&)> publish_mapped_scan_;
  std::function<void(const strata_msgs::msg::ReflectionGrid&)> publish_filtered_;
  std::function<void(const nav_msgs::msg::OccupancyGrid&)> publish_map_;
  std::function<void(const tf2_msgs::msg::TFMessage&)> publish_tf_;
};

}  // namespace strata::scan_matcher
