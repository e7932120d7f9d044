// SPDX-License-Identifier: Apache-2.0
/// Whether odometry that came has stopped, told by the scans' stamps: its own may be of any clock.
#pragma once

#include <optional>

#include "core/base/time.hpp"

namespace strata::runtime {

class OdometrySilence {
 public:
  void hear_odometry() { first_scan_since_.reset(); }
  void hear_scan(Stamp stamp) {
    if (!first_scan_since_) first_scan_since_ = stamp;
  }
  /// Whether scans have come for that long, up to `now`, without any odometry.
  [[nodiscard]] bool has_lasted(double seconds, Stamp now) const {
    return first_scan_since_ && (now - *first_scan_since_).seconds() >= seconds;
  }

 private:
  std::optional<Stamp> first_scan_since_;
};

}  // namespace strata::runtime
