// SPDX-License-Identifier: Apache-2.0
#include "components/scan_matcher/scan_matcher.hpp"

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>

#include "components/convert/geometry_messages.hpp"
#include "components/convert/map_messages.hpp"
#include "components/convert/scan_messages.hpp"
#include "components/log/kept_file.hpp"
#include "components/log/stored_bytes.hpp"
#include "components/maps/maps_folder.hpp"
#include "core/base/error.hpp"
#include "core/slam/log_checks.hpp"
#include "core/slam/resumed_place.hpp"

namespace strata::scan_matcher {

void ScanMatcher::on_configure() {
  config_ = read_parameters<ScanMatcherConfig>();
  keep_live<ScanMatcherConfig>({"publish_tf"}, [this](const ScanMatcherConfig& changed) {
    config_.publish_tf = changed.publish_tf;
  });
  make_slam();
  advertise_topics();
  subscribe<strata_msgs::msg::ScanPose>("given_pose", "default",
                                        [this](const auto& message) { given_ = message; });
  subscribe_sensors(config_.input, config_.sensor_qos,
                    config_.publish_tf ? config_.odometry_frame : "");
  if (lockstep()) return;
  open_live_maps();
  open_store();
  if (saver_ && saver_->has_maps()) go_on_from_folder();
}

void ScanMatcher::advertise_topics() {
  publish_scan_pose_ = advertise<strata_msgs::msg::ScanPose>("scan_pose", "default");
  publish_posed_scan_ = advertise<strata_msgs::msg::LabeledScan>("posed_scan", "default");
  publish_mapped_scan_ = advertise<strata_msgs::msg::LabeledScan>("mapped_scan", "lossless");
  publish_filtered_ = advertise<strata_msgs::msg::ReflectionGrid>("reflection_filtered", "latched");
  publish_map_ = advertise<nav_msgs::msg::OccupancyGrid>("map", "latched");
  publish_tf_ = advertise<tf2_msgs::msg::TFMessage>("/tf", "tf");
}

void ScanMatcher::make_slam() {
  slam_ = std::make_unique<slam::Slam>(config_.slam, context().threads,
                                       lockstep() ? slam::KeepConfig{} : config_.live);
}

void ScanMatcher::open_store() {
  if (config_.store.state.file.empty()) return;
  log::require_own_file(config_.store.state.file, log::kStateOfScanMatcher, "store.file");
  if (context().dry_run) return;
  store_.emplace(config_.store.state);
  const bool is_whole = restored(store_->file(), [&] {
    if (const auto state = store_->load()) slam_->restore_state(*state, store_->file());
  });
  if (!is_whole) make_slam();
  is_restored_ = slam_->newest().has_value();
}

bool ScanMatcher::resume(const Observation& first) {
  const slam::Slam::Newest kept = *slam_->newest();
  const runtime::KeptMoment moment{kept.stamp, kept.odom_from_robot.has_value()};
  waits_for_odometry_ = config_.input.use_odometry &&
                        runtime::needs_odometry(moment, first, config_.store.dead_reckoning);
  if (waits_for_odometry_) return false;
  is_restored_ = false;
  const std::optional<Pose2> unbroken = by_unbroken_odometry(kept, first);
  is_set_back_ = false;
  if (!kept.is_placed) {
    first_run_ = kept.run + 1;
    return true;
  }
  const bool is_recent =
      unbroken || runtime::is_dead_reckoned(moment, first, config_.store.dead_reckoning);
  const Eigen::Matrix3d covariance =
      pose_covariance(config_.store.stddev_m, config_.store.stddev_rad);
  const slam::ResumedRun resumed =
      slam::resume_run(*slam_, first, is_recent, config_.slam.beam_filter, covariance);
  first_run_ = resumed.run;
  if (unbroken && resumed.run == kept.run) {  // it fits nowhere; stamps of a run only grow
    slam_->begin_next_run_at({*unbroken, covariance});
    first_run_ = kept.run + 1;
    return true;
  }
  if (resumed.fits) return true;
  tell(
      InputError(full_name(),
                 "the first scan does not look as the kept map does where the robot is taken to be",
                 resumed.run == kept.run
                     ? "it goes on by its odometry; nothing needs to be done where it drove into "
                       "the unknown"
                     : "drive it to where it was, or begin anew: move all stores of this "
                       "composition away"));
  return true;
}

std::optional<Pose2> ScanMatcher::by_unbroken_odometry(const slam::Slam::Newest& kept,
                                                       const Observation& first) const {
  if (!is_set_back_ || !kept.odom_from_robot || !first.has_odometry) return std::nullopt;
  // Between two scans, and the one that was held back until it was sure, no robot goes further.
  constexpr double kMaxStep_m = 2.0;
  const Pose2 step = between(*kept.odom_from_robot, first.odom_from_robot);
  if (step.translation().norm() > kMaxStep_m) return std::nullopt;
  return kept.map_from_robot * step;
}

void ScanMatcher::on_activate() { publish_maps(); }

void ScanMatcher::on_tick() {
  publish_maps();
  save_maps_now_and_then();
  if (saver_) guarded([this] { check_saver(); });
  if (store_) store_->check();
}

void ScanMatcher::on_deactivate() {
  if (!slam_->newest()) return;
  if (store_) {
    store_->write(slam_->save_state());
    guarded([this] { store_->flush(); });  // the maps may have room elsewhere
  }
  if (!saver_) return;
  guarded([this] { check_saver(); });
  if (has_unsaved()) save_maps({});
  saver_->flush();
}

/// Its map is gone on with as after a restart: in a new run, where the scan fits.
std::string ScanMatcher::on_clock_set_back() {
  is_restored_ = is_set_back_ = slam_->newest().has_value();
  return "the map is gone on with";
}

void ScanMatcher::on_observation(const Observation& scanned) {
  Observation observation = scanned;
  const std::optional<Pose2> given = convert::take_given(given_, observation);
  if (!lockstep() && slam::LogChecks::reason_to_skip(observation, given ? &*given : nullptr)) {
    pass_over(observation);
    return;
  }
  if (is_restored_ && !resume(observation)) return;
  observation.run += first_run_;
  const std::size_t skipped = slam_->skipped_scans();
  const Pose2Gaussian pose = slam_->add(observation, given ? &*given : nullptr);
  if (!lockstep() && slam_->skipped_scans() > skipped) return;  // out of order, or repeated
  tell_forgotten_runs();
  if (store_ && store_->is_due(observation.scan.stamp)) store_->write(slam_->save_state());
  is_lost_ = !lockstep() && slam_->newest() && !slam_->newest()->is_placed;
  if (is_lost_) return;  // the pose is in a frame of the run
  publish_pose(observation, pose);
  publish_posed_scan_(convert::to_message(
      PosedScan{observation.run, observation.scan, pose.mean, {}}, config_.map_frame, "laser"));
  last_ = std::move(observation);
  last_.scan.ranges_m.clear();
  publish_maps();
}

void ScanMatcher::tell_forgotten_runs() {
  const std::size_t runs = slam_->forgotten_unplaced().runs;
  if (std::exchange(forgotten_runs_, runs) == runs) return;
  tell(InputError(full_name(),
                  "a run that ended without a place in the map is forgotten, with what it saw",
                  "begin runs where the robot was when the one before ended, or drive each to a "
                  "place that the map knows; live.window_scans says how long they are kept"));
}

/// A scan that says nothing of where the robot is.
void ScanMatcher::pass_over(const Observation& observation) {
  ++unusable_scans_;
  const bool is_newer = observation.scan.stamp > last_.scan.stamp;
  if (is_newer && observation.has_odometry && !is_lost_) publish_tf(observation.scan.stamp);
}

void ScanMatcher::publish_scan_pose(const Observation& observation, const Pose2Gaussian& pose) {
  strata_msgs::msg::ScanPose message;
  message.header(convert::make_header(observation.scan.stamp, config_.map_frame));
  message.run(observation.run);
  message.index(index_);
  message.map_from_robot(convert::to_message(pose));
  message.odom_from_robot(convert::to_message(observation.odom_from_robot));
  message.has_odometry(observation.has_odometry);
  publish_scan_pose_(message);
}

void ScanMatcher::publish_pose(const Observation& observation, const Pose2Gaussian& pose) {
  publish_scan_pose(observation, pose);
  ++index_;
  if (!observation.has_odometry) return;
  map_from_odom_ = pose.mean * inverse(observation.odom_from_robot);
  publish_tf(observation.scan.stamp);
}

void ScanMatcher::publish_tf(Stamp stamp) {
  if (!config_.publish_tf || !map_from_odom_) return;
  tf2_msgs::msg::TFMessage tf;
  tf.transforms().push_back(convert::to_transform_stamped(stamp, *map_from_odom_, config_.map_frame,
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
  if (!result.scans.empty() && index_ > 0) {
    --index_;  // once more, since loops may have moved it: a localizer can begin there
    Observation last = last_;
    last.scan.stamp = stamp;
    last.has_odometry = last.has_odometry && last_.scan.stamp == stamp;
    publish_scan_pose(last, {result.scans.back().map_from_robot, Eigen::Matrix3d::Zero()});
  }
  publish_filtered_(convert::to_message(result.filtered));
  publish_map_(convert::to_occupancy(result.occupancy, stamp, config_.map_frame));
}

void ScanMatcher::on_diagnose(runtime::Health& health) const {
  diagnose_input(health);
  if (waits_for_odometry_) health.warn("waits for odometry, to go on from its store");
  if (is_lost_) health.warn("looks for its place in the map of the earlier runs");
  health.add("scans kept", static_cast<std::uint64_t>(slam_->kept_scans()));
  health.add("scans left out",
             unusable_scans_ + static_cast<std::uint64_t>(slam_->skipped_scans()));
  health.add("local maps kept", static_cast<std::uint64_t>(slam_->kept_local_maps()));
  health.add("scans forgotten without a place",
             static_cast<std::uint64_t>(slam_->forgotten_unplaced().scans));
  if (store_) health.add_later("store_bytes", [this] { return log::stored_bytes(store_->file()); });
  if (!saver_) return;
  health.add("seconds the last saving of maps took", saver_->last_s());
  health.add("saved sub-maps at live poses", static_cast<std::uint64_t>(saver_->live_submaps()));
}

void ScanMatcher::on_cleanup() {
  store_.reset();
  publisher_.reset();
  saver_.reset();
  patches_.reset();
  saved_mapped_ = 0;
  has_new_patches_ = false;
  slam_.reset();
  is_restored_ = false;
  is_set_back_ = false;
  unusable_scans_ = 0;
  forgotten_runs_ = 0;
  waits_for_odometry_ = false;
  is_lost_ = false;
  map_from_odom_.reset();
  first_run_ = 0;
  index_ = 0;
}

}  // namespace strata::scan_matcher
