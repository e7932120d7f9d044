// SPDX-License-Identifier: Apache-2.0
/// When the beams of a sweep were really taken: drivers turn a sweep round without saying so, and
/// stamp it at its end.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>

#include "core/scan/scan.hpp"
#include "core/scan/undistort.hpp"

namespace strata::registration {

/// Odometry at a moment, odom_from_robot; nothing where there is none.
using OdometryAt = std::function<std::optional<Pose2>(Stamp)>;

struct SweepTimingEstimate {
  SweepTiming timing;          ///< as the messages state it when not certain
  bool certain = false;        ///< the scans clearly contradict what the messages state
  std::size_t pairs = 0;       ///< consecutive scans compared, taken while turning
  double stated_cost = 0.0;    ///< mean cost of matching a pair with the stated timing [nats]
  double estimate_cost = 0.0;  ///< ... with `timing`
};

/// Undistorts and matches consecutive scans, those between which the robot turned most, under both
/// orders of beams and delays from minus one to two sweeps, and takes the timing under which they
/// agree best. What the messages state stays unless another timing lowers the cost by a tenth and
/// on three pairs of four. scans: one run, in time order, as recorded. Needs time_increment_s; with
/// fewer than 8 pairs that turn by 0.03 rad nothing is certain. Our own check, not in the papers.
/// stated: what the messages state. O(pairs x delays x beams).
[[nodiscard]] SweepTimingEstimate estimate_sweep_timing(std::span<const Scan> scans,
                                                        const OdometryAt& odometry,
                                                        const SweepTiming& stated = {});

}  // namespace strata::registration
