// SPDX-License-Identifier: Apache-2.0
/// strata::ScanMatcher: scans and odometry in; poses and growing maps out, and at the end of a log
/// everything slam::Slam::finish makes.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "components/log/state_store.hpp"
#include "components/runtime/sensor_component.hpp"
#include "components/scan_matcher/config.hpp"
#include "components/scan_matcher/map_publisher.hpp"
#include "components/scan_matcher/maps_saver.hpp"
#include "core/slam/slam.hpp"

namespace strata::scan_matcher {

/// In, beside scans and odometry: given_pose (ScanPose), which says the run of the scan of its
/// stamp and, unless NaN, its pose; it has to come first, as in lockstep. Out: scan_pose
/// (ScanPose), posed_scan (LabeledScan without labels), /tf. Live, as the map grows (MapPublisher):
/// map, map_filtered, reflection_filtered, trajectory (nav_msgs/Path, the poses of the scans as
/// known now); and MAPS (MapsSaver), on ~/save (std_srvs/Trigger), on deactivation and now and
/// then. In lockstep, after finish: mapped_scan (LabeledScan with final poses and labels, one a
/// scan), the last scan's final scan_pose, reflection_filtered and map; and the grid maps and the
/// trajectory in MAPS. Memory: live the window and the map (slam::KeepConfig), in lockstep every
/// scan, for finish. Live it goes on from its store.
class ScanMatcher final : public runtime::SensorComponent {
 public:
  using SensorComponent::SensorComponent;

 private:
  void on_declare() override { declare_parameters<ScanMatcherConfig>(); }
  void on_configure() override;
  void on_cleanup() override;
  void on_activate() override;
  void on_deactivate() override;
  void on_tick() override;
  void on_finish(const std::filesystem::path& out_dir) override;
  void on_diagnose(runtime::Health& health) const override;
  void on_observation(const Observation& observation) override;
  [[nodiscard]] std::string on_clock_set_back() override;
  [[nodiscard]] bool learns() const override { return true; }
  void make_slam();
  void advertise_topics();
  void open_store();
  void open_live_maps();
  /// Takes over the patches of the folder that will be replaced and, without a state to go on
  /// from, its scans.
  void go_on_from_folder();
  void take_patches(const strata_msgs::msg::PatchMap& message);
  void publish_maps();
  /// done: may be empty.
  void save_maps(MapsSaver::Done done);
  void save_maps_now_and_then();
  void check_saver();
  /// Whether the map or the patches have grown since they were saved. O(what is kept).
  [[nodiscard]] bool has_unsaved() const;
  [[nodiscard]] std::size_t newest_mapped() const;
  /// Decides whether the first scan goes on with the run that was kept, or begins the next one;
  /// false when that cannot be told before odometry comes.
  [[nodiscard]] bool resume(const Observation& first);
  /// Where the robot is when its clock was set back, and odometry has gone on: nothing when it has
  /// not.
  [[nodiscard]] std::optional<Pose2> by_unbroken_odometry(const slam::Slam::Newest& kept,
                                                          const Observation& first) const;
  void publish_pose(const Observation& observation, const Pose2Gaussian& pose);
  /// Where odometry's frame is, as far as it is known.
  void publish_tf(Stamp stamp);
  void pass_over(const Observation& observation);
  void tell_forgotten_runs();
  void publish_scan_pose(const Observation& observation, const Pose2Gaussian& pose);
  void publish_result(const slam::SlamResult& result);

  ScanMatcherConfig config_;
  std::unique_ptr<slam::Slam> slam_;
  std::optional<strata_msgs::msg::ScanPose> given_;
  std::optional<log::StateStore> store_;
  bool is_restored_ = false;         ///< and no scan has come since
  bool is_set_back_ = false;         ///< the clock, and no scan has come since
  bool waits_for_odometry_ = false;  ///< to go on with the run that was kept
  bool is_lost_ = false;             ///< live: the run has no place in the map yet
  int first_run_ = 0;
  std::optional<MapPublisher> publisher_;  ///< live only
  std::optional<MapsSaver> saver_;         ///< live, with a folder
  std::size_t saved_mapped_ = 0;
  bool has_new_patches_ = false;
  std::chrono::steady_clock::time_point saved_;
  std::optional<strata_msgs::msg::PatchMap> patches_;
  Observation last_;  ///< without its ranges
  std::optional<Pose2> map_from_odom_;
  std::uint64_t unusable_scans_ = 0;
  std::size_t forgotten_runs_ = 0;  ///< that people were told of
  std::uint64_t index_ = 0;
  std::function<void(const strata_msgs::msg::ScanPose&)> publish_scan_pose_;
  std::function<void(const strata_msgs::msg::LabeledScan&)> publish_posed_scan_;
  std::function<void(const strata_msgs::msg::LabeledScan&)> publish_mapped_scan_;
  std::function<void(const strata_msgs::msg::ReflectionGrid&)> publish_filtered_;
  std::function<void(const nav_msgs::msg::OccupancyGrid&)> publish_map_;
  std::function<void(const tf2_msgs::msg::TFMessage&)> publish_tf_;
};

}  // namespace strata::scan_matcher
