// SPDX-License-Identifier: Apache-2.0
/// Odometry at any moment.
#pragma once

#include <optional>
#include <vector>

#include "components/log/log_reader.hpp"

namespace strata::log {

/// As mend_set_back_clock. samples: in the order of recording.
void mend_odometry_clock(std::vector<OdometrySample>& samples);

/// Samples sorted by stamp; a sample's own stamp gives back its very pose.
class OdometryTrack {
 public:
  explicit OdometryTrack(std::vector<OdometrySample> samples);
  [[nodiscard]] bool empty() const { return samples_.empty(); }
  [[nodiscard]] const std::vector<OdometrySample>& samples() const { return samples_; }
  /// Interpolated; outside the samples, or in a hole of theirs, the nearest one within max_gap_s,
  /// else nothing. O(log samples).
  [[nodiscard]] std::optional<Pose2> at(Stamp stamp, double max_gap_s) const;

 private:
  std::vector<OdometrySample> samples_;
};

}  // namespace strata::log
