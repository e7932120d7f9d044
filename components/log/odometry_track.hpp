// SPDX-License-Identifier: Apache-2.0
/// Odometry at any moment.
#pragma once

#include <optional>
#include <vector>

#include "core/base/time.hpp"
#include "core/geometry/pose2.hpp"

namespace strata::log {

/// Odometry between scans; kept so that converting a log loses none.
struct OdometrySample {
  Stamp stamp;
  Pose2 odom_from_robot;
};

/// As mend_set_back_clock. samples: in the order of recording.
void mend_odometry_clock(std::vector<OdometrySample>& samples);

/// Samples sorted by stamp; a sample's own stamp gives back its very pose.
class OdometryTrack {
 public:
  OdometryTrack() = default;
  explicit OdometryTrack(std::vector<OdometrySample> samples);
  [[nodiscard]] bool empty() const { return samples_.empty(); }
  [[nodiscard]] const std::vector<OdometrySample>& samples() const { return samples_; }
  /// In any order; of equal stamps the first one counts. O(1), O(samples) when late.
  void add(const OdometrySample& sample);
  /// Samples older than keep_s behind the newest go, in pieces: at most twice as much is kept.
  void forget(double keep_s);
  void clear() { samples_.clear(); }
  /// Interpolated; outside the samples, or in a hole of theirs, the nearest one within max_gap_s,
  /// else nothing. O(log samples).
  [[nodiscard]] std::optional<Pose2> at(Stamp stamp, double max_gap_s) const;
  /// The same, but nothing where a neighbour is missing.
  [[nodiscard]] std::optional<Pose2> between_samples(Stamp stamp, double max_gap_s) const;

 private:
  struct Neighbours {
    const OdometrySample* before = nullptr;
    const OdometrySample* after = nullptr;
  };
  [[nodiscard]] Neighbours neighbours(Stamp stamp, double max_gap_s) const;
  std::vector<OdometrySample> samples_;
};

}  // namespace strata::log
