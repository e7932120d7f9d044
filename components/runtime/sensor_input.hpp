// SPDX-License-Identifier: Apache-2.0
/// Joins what a robot publishes apart: scans, odometry and the mountings of its scanners.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "strata_idl/nav_msgs.h"
#include "strata_idl/sensor_msgs.h"
#include "strata_idl/tf2_msgs.h"

#include "components/log/robot_frames.hpp"
#include "components/runtime/clock_gap.hpp"
#include "components/runtime/diagnostics.hpp"
#include "components/runtime/live_odometry.hpp"
#include "components/runtime/odometry_clock_watch.hpp"
#include "components/runtime/odometry_silence.hpp"
#include "components/runtime/scan_queue.hpp"
#include "components/runtime/sensor_input_config.hpp"
#include "core/scan/scan.hpp"

namespace strata::runtime {

/// What a log reader does with a log (log::read_bag), message by message, to the same bits: a scan
/// upside down is turned round, odometry is interpolated within max_odometry_gap_s, sweeps are
/// undistorted (in lockstep the player has), scanners' scans are put in order of time. A scan waits
/// until odometry has reached the end of its sweep, its mounting is known, and no other scanner is
/// expected to send an older one; when too many wait, the oldest goes on without. A mounting, or
/// odometry, that nobody has published is waited for longer (first_wait_s), then told once and
/// waited for no more; so is odometry that stops, until it comes again on whatever topic. Odometry
/// stamped late or early against the scans (odometry_lag_s) is noticed by their turns, told, and
/// corrected from then on.
class SensorInput {
 public:
  /// waits: false in lockstep, where everything that belongs to a scan came before it.
  SensorInput(SensorInputConfig config, bool waits)
      : config_(std::move(config)),
        waits_(waits),
        frames_(config_.robot_frame),
        queue_(waits),
        lag_s_(config_.odometry_lag_s) {}

  /// /tf_static. Transforms that are not finite are told and passed over.
  void add(const tf2_msgs::msg::TFMessage& transforms);
  /// /tf, for robots that give odometry there only. The first nav_msgs/Odometry ends that.
  void add_moving(const tf2_msgs::msg::TFMessage& transforms);
  void add(const nav_msgs::msg::Odometry& odometry);
  /// topic: its place in SensorInputConfig::all_scan_topics. Throws InputError, and forgets the
  /// scan, when its angles or limits are none (log::sensed).
  void add(const sensor_msgs::msg::LaserScan& scan, std::size_t topic = 0);
  /// topic: as above; those with clouds come after the others. Throws InputError for clouds
  /// that cannot be read.
  void add(const sensor_msgs::msg::PointCloud2& cloud, std::size_t topic);
  /// The scans that are complete now, in order of time.
  [[nodiscard]] std::vector<Observation> take();
  /// When a scanner's clock was found to be set back since the last call: how many of those that
  /// `take` gave since then are by the old one; the next ones, maybe of a later call, are by the
  /// new one.
  [[nodiscard]] std::optional<std::size_t> take_set_back();

  /// How the robot has moved since then, up to the newest odometry; nothing where no odometry of
  /// that moment is known (the last half minute is kept).
  [[nodiscard]] std::optional<Pose2> moved_since(Stamp stamp) const;

  /// Compares the turns of an observation of `take` with odometry's, for those that come. It takes
  /// longer than all else here: work on the observation first. O(turns x beams).
  void watch_clock(const Observation& observation);

  /// What was met since the last call, each kind once.
  [[nodiscard]] std::vector<std::string> take_warnings();
  void diagnose(Health& health) const;

 private:
  struct Source {
    const LiveOdometry* odometry = nullptr;
    std::string child;
  };
  void add_sensed(log::SensedScan sensed, std::size_t topic);
  void add_odometry(LiveOdometry& odometry, Stamp stamp, const Pose2& odom_from_child);
  void warn_not_finite(const std::string& topic,
                       const geometry_msgs::msg::TransformStamped& transform);
  void warn(const std::string& sentence);
  /// Whatever its numbers are now, a sentence of this kind is told once; an empty one never.
  void warn_once(const std::string& kind, const std::string& sentence);
  /// A scan goes on, or is left out, while odometry comes.
  void watch_gap(bool has_odometry, Stamp scan, const LiveOdometry& odometry);
  [[nodiscard]] Source source() const;
  [[nodiscard]] bool has_odometry_for(const WaitingScan& waiting, const Source& source) const;
  [[nodiscard]] bool has_mounting(const WaitingScan& waiting, const Source& source) const;
  [[nodiscard]] bool is_complete(const WaitingScan& waiting, const Source& source) const;
  /// Nobody has published any, and it is still waited for.
  [[nodiscard]] bool lacks_odometry(const Source& source) const;
  [[nodiscard]] bool has_waited_long(const WaitingScan& oldest) const;
  void give_up(const WaitingScan& waiting);
  void give_up_odometry(const std::string& sentence);
  [[nodiscard]] std::string without_odometry(const std::string& what) const;
  void release();

  SensorInputConfig config_;
  bool waits_;
  log::RobotFrames frames_;
  ScanQueue queue_;
  bool has_odometry_topic_ = false;
  std::string topic_child_;
  LiveOdometry topic_odometry_;
  std::map<std::string, LiveOdometry> moving_;  ///< from /tf, by child of the odometry frame
  double lag_s_ = 0.0;                          ///< taken off odometry's stamps
  OdometryClockWatch clock_;
  ClockGap gap_;
  std::optional<double> ahead_s_;  ///< as gap_ has it
  OdometrySilence silence_;
  bool is_without_odometry_ = false;  ///< nobody published any when it was due, or it stopped
  std::set<std::string> assumed_;     ///< frames without a mounting when it was due
  std::vector<Observation> ready_;
  std::optional<std::size_t> by_old_clock_;  ///< of those in ready_
  std::set<std::string> told_;
  std::vector<std::string> warnings_;
  std::string other_odometry_frame_;  ///< of /tf, by its name; of other robots too
  std::uint64_t passed_over_ = 0;
  std::uint64_t of_new_frames_ = 0;  ///< scans that were left out
  std::uint64_t bad_transforms_ = 0;
  std::uint64_t bad_odometry_ = 0;
};

}  // namespace strata::runtime
