// SPDX-License-Identifier: Apache-2.0
/// What a robot's other scanners saw just before.
#pragma once

#include <vector>

#include "core/scan/scan.hpp"

namespace strata::localization {

/// The newest scan of each scanner, told apart by their mountings, until it is weighed. A scan that
/// sees one side alone pulls the pose to that side wherever the map is a little off: weighed
/// together with the others', whose pulls are different ones, it does not.
class CompanionScans {
 public:
  struct Companion {
    Observation observation;
    Pose2 now_from_then;  ///< by odometry
    Scan scan;            ///< as if taken from where the robot is now
  };
  void clear() { kept_.clear(); }
  /// Keeps the scan in place of the one before of its scanner. Allocates nothing once it has seen
  /// as many scanners with scans as long. O(beams).
  void keep(const Observation& observation);
  /// The others' scans, of the run and of the last half second, that were not taken before; those
  /// whose motion until now odometry does not tell are left out. They and this one count as taken.
  [[nodiscard]] const std::vector<Companion*>& take(const Observation& now);

 private:
  struct Kept {
    Companion companion;
    bool is_fresh = true;
  };
  std::vector<Kept> kept_;
  std::vector<Companion*> taken_;
};

}  // namespace strata::localization
