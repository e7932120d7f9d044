// SPDX-License-Identifier: Apache-2.0
/// The odometry of a running robot: late, repeated, and by a clock that may be set back.
#pragma once

#include <functional>
#include <optional>

#include "components/log/odometry_track.hpp"
#include "components/log/set_back_watch.hpp"

namespace strata::runtime {

/// Keeps the last half minute. A sample from long before the newest one is held back until the next
/// one tells whether the clock was set back, or it merely came late.
class LiveOdometry {
 public:
  /// set_back: called when the clock was set back, before what was kept is forgotten, with the
  /// first stamp by the new clock. at_once: any older stamp is another run (lockstep).
  void add(const log::OdometrySample& sample, bool at_once,
           const std::function<void(Stamp)>& set_back);
  void begin_anew();
  [[nodiscard]] const log::OdometryTrack& track() const { return track_; }
  /// Whether odometry has reached that moment.
  [[nodiscard]] bool reaches(Stamp stamp) const {
    return !track_.empty() && track_.samples().back().stamp >= stamp;
  }

 private:
  log::OdometryTrack track_;
  log::SetBackWatch watch_;
  std::optional<log::OdometrySample> suspect_;
};

}  // namespace strata::runtime
