// SPDX-License-Identifier: Apache-2.0
/// Drives of a recorded robot, or parts of them put one behind the other: as a robot has it that is
/// carried away.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "core/localization/localizer.hpp"
#include "tools/laboratory/experiments/verdict_worlds.hpp"
#include "tools/pipeline/compare_config.hpp"

namespace strata::experiments {

/// The sensor model of that name in the world's maps; "field": end points in the filtered map.
[[nodiscard]] std::shared_ptr<const localization::SensorModel> sensor_of(const VerdictWorld& world,
                                                                         const std::string& model);

/// The localizer takes its pose for good: one place, little spread, and the verdict is good.
[[nodiscard]] bool is_sure(const localization::LocalizationResult& result);

/// The first place from `at` on whose truth is known; the number of observations if there is none.
[[nodiscard]] std::size_t known_from(const VerdictWorld& world, std::size_t at);

/// A localizer that sees parts of a drive as if each followed on the one before.
class SplicedDrive {
 public:
  SplicedDrive(const VerdictWorld& world, std::shared_ptr<const localization::SensorModel> sensor,
               std::uint64_t seed,
               const localization::LocalizerConfig& config = pipeline::CompareConfig{}.localizer)
      : world_(&world), localizer_(config, std::move(sensor), seed) {}

  [[nodiscard]] localization::Localizer& localizer() { return localizer_; }

  /// Of the scan that is told of, or was last.
  [[nodiscard]] const Pose2& truth() const { return truth_; }

  /// At the pose, as `compare` starts.
  void start(const Pose2& map_from_robot) {
    const pipeline::CompareProtocol protocol;
    const double m = protocol.start_stddev_m;
    const double rad = protocol.start_stddev_rad;
    localizer_.initialize({map_from_robot, Eigen::Vector3d(m * m, m * m, rad * rad).asDiagonal()});
  }

  /// Calls said(result, error in m, stamp) for each weighed scan
  /// of [begin, end) whose truth is known, until that returns false. Ends early where the log
  /// itself has a gap.
  template <typename Said>
  void drive(std::size_t begin, std::size_t end, Said&& said) {
    for (std::size_t i = begin; i < std::min(end, world_->observations.size()); ++i) {
      if (i > begin && !move(world_->observations[i - 1], world_->observations[i])) return;
      constexpr double kScan_s = 0.1;
      if (i == begin) stamp_ = Stamp::from_seconds(stamp_.seconds() + kScan_s);
      Observation observation = world_->observations[i];
      observation.run = 0;
      observation.odom_from_robot = odom_;
      observation.scan.stamp = stamp_;
      const localization::LocalizationResult& result = localizer_.update(observation);
      if (!result.weighed || !world_->truths[i]) continue;
      truth_ = *world_->truths[i];
      const double error_m = (result.pose.mean.translation() - truth_.translation()).norm();
      if (!said(result, error_m, stamp_)) return;
    }
  }

 private:
  bool move(const Observation& before, const Observation& now) {
    const Pose2 motion = between(before.odom_from_robot, now.odom_from_robot);
    odom_ = odom_ * motion;
    stamp_ = Stamp::from_seconds(stamp_.seconds() + (now.scan.stamp - before.scan.stamp).seconds());
    constexpr double kJump_m = 1.5;
    return std::hypot(motion.x, motion.y) < kJump_m;
  }

  const VerdictWorld* world_;
  localization::Localizer localizer_;
  Pose2 odom_;
  Pose2 truth_;
  Stamp stamp_ = Stamp::from_seconds(1.0);
};

}  // namespace strata::experiments
