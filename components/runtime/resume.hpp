// SPDX-License-Identifier: Apache-2.0
/// Whether odometry connects what a component kept with its first scan after a restart.
#pragma once

#include "core/base/config.hpp"
#include "core/base/time.hpp"
#include "core/scan/scan.hpp"

namespace strata::runtime {

struct DeadReckoningConfig {
  double dead_reckoning_s = 10.0;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.renamed("carry_s", "dead_reckoning_s");
    v.field(
        "dead_reckoning_s", c.dead_reckoning_s,
        {.doc = "when the first scan is at most this much younger than the newest one kept, "
                "odometry is thought to have gone on, and says how far the robot has moved, unless "
                "the scan fits where the robot was and not there; later the robot is thought to be "
                "where it was, unless the scan fits where odometry says",
         .unit = "s",
         .min = 0.0});
  }
};

/// Of the newest scan that was kept.
struct KeptMoment {
  Stamp stamp;
  bool has_odometry = false;
};

/// The odometry of both scans is of one frame. A clock that was set back tells nothing.
[[nodiscard]] bool is_dead_reckoned(const KeptMoment& kept, const Observation& first,
                                    const DeadReckoningConfig& config);

/// It would be, had odometry come with the scan: a later one may have it, since scans may be heard
/// before odometry is.
[[nodiscard]] bool needs_odometry(const KeptMoment& kept, const Observation& first,
                                  const DeadReckoningConfig& config);

}  // namespace strata::runtime
