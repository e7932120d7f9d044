// SPDX-License-Identifier: Apache-2.0
/// A robot that drives round a block for as long as it is asked.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "tests/core/slam/ring_world.hpp"

namespace strata::bench {

inline constexpr double kScanPeriod_s = 0.2;
inline constexpr double kRound_m = 40.0;
inline constexpr double kStep_m = 0.14;  // 0.7 m/s
inline constexpr std::size_t kRecordedRounds = 4;

/// Scans of a few rounds, each with noise of its own, with steps of odometry that drift.
class EndlessDrive {
 public:
  /// changing: a box stands in the corridor in every other recording. A recording is half a step
  /// more than whole rounds: the last pose is the first one again.
  explicit EndlessDrive(bool changing = false)
      : path_(test::drive_round(kStep_m, kRecordedRounds * kRound_m + 0.5 * kStep_m)) {
    logs_.push_back(test::record(test::ring(), path_, 0, 1));
    if (!changing) return;
    std::vector<test::Wall> walls = test::ring();
    walls.push_back({8.0, 8.6, 8.6, 8.6});
    walls.push_back({8.6, 8.6, 8.6, 8.0});
    walls.push_back({8.0, 8.0, 8.0, 8.6});
    logs_.push_back(test::record(walls, path_, 0, 2));
  }
  /// The next of endlessly many.
  const Observation& next() {
    const std::vector<Observation>& log = logs_[log_];
    const Pose2 recorded = log[at_].odom_from_robot;
    // The last recorded pose is the first one's again: from there the robot has not moved.
    if (at_ > 0) odometry_ = odometry_ * between(before_, recorded);
    before_ = recorded;
    out_ = log[at_];
    out_.odom_from_robot = odometry_;
    out_.scan.stamp = Stamp::from_seconds(1.0 + kScanPeriod_s * static_cast<double>(count_++));
    truth_ = path_[at_];
    if (++at_ == log.size()) {
      at_ = 0;
      log_ = (log_ + 1) % logs_.size();
    }
    return out_;
  }
  /// Where the last one was taken.
  [[nodiscard]] const Pose2& truth() const { return truth_; }
  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] double hours() const {
    return kScanPeriod_s * static_cast<double>(count_) / 3600.0;
  }

 private:
  std::vector<Pose2> path_;
  std::vector<std::vector<Observation>> logs_;
  Observation out_;
  std::size_t log_ = 0;
  std::size_t at_ = 0;
  std::size_t count_ = 0;
  Pose2 odometry_;
  Pose2 before_;
  Pose2 truth_;
};

}  // namespace strata::bench
