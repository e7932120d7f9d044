// SPDX-License-Identifier: Apache-2.0
/// strata::Localizer: scans, odometry and a MAPS folder in; where the robot is out.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>

#include "components/localizer/config.hpp"
#include "components/maps/localization_files.hpp"
#include "components/maps/map_model.hpp"
#include "components/runtime/component.hpp"
#include "components/runtime/sensor_input.hpp"
#include "core/localization/localizer.hpp"

namespace strata::localizer {

/// Out, once a scan: amcl_pose, map -> odom on /tf (REP 105; as AMCL), particle_cloud,
/// submap_states (maps with sub-maps only), localization_health. In: initialpose. At the end of a
/// log trajectory.tum, states.csv and metrics.json, byte for byte those of `strata localize`
/// without truth but for the cost.
class Localizer final : public runtime::Component {
 public:
  using Component::Component;

 private:
  void on_configure() override;
  void on_cleanup() override;
  void on_diagnose(runtime::Health& health) const override;
  void on_finish(const std::filesystem::path& out_dir) override;
  void load_maps();
  void advertise_topics();
  void subscribe_topics();
  void restart(const geometry_msgs::msg::PoseWithCovarianceStamped& message);
  void take_observations();
  void localize(const Observation& observation);
  void publish_pose(const Observation& observation, const Pose2Gaussian& pose);
  void publish_particles(Stamp stamp);
  void publish_states(Stamp stamp, const std::vector<localization::SubmapBelief>& submaps);
  void publish_health(Stamp stamp, const localization::LocalizationResult& result,
                      std::chrono::duration<double> update_time);

  LocalizerComponentConfig config_;
  std::optional<runtime::SensorInput> input_;
  maps::MapModel model_;
  std::unique_ptr<localization::Localizer> localizer_;
  std::optional<strata_msgs::msg::LocalizationHealth> health_;  // as of the last scan
  maps::LocalizationRecord record_;  // lockstep only: live it would grow without end
  std::function<void(const geometry_msgs::msg::PoseWithCovarianceStamped&)> publish_pose_;
  std::function<void(const tf2_msgs::msg::TFMessage&)> publish_tf_;
  std::function<void(const strata_msgs::msg::SubmapStates&)> publish_states_;
  std::function<void(const strata_msgs::msg::LocalizationHealth&)> publish_health_;
  std::shared_ptr<bus::RawWriter> particle_writer_;  // raw, to see whether somebody reads
};

}  // namespace strata::localizer
