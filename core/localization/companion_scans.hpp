// SPDX-License-Identifier: Apache-2.0
/// What a robot's other scanners saw just before.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/scan/scan.hpp"

namespace strata::localization {

/// The newest scan of each scanner, told apart by their mountings, until it is weighed. A scan that
/// sees one side alone pulls the pose to that side wherever the map is a little off: weighed
/// together with the others', whose pulls are different ones, it does not. What several see in one
/// direction counts once, as in the one scan that a merger would make of them: else the pose is
/// pulled by what both see, at the price of as many beams.
class CompanionScans {
 public:
  struct Companion {
    Observation observation;
    Pose2 now_from_then;  ///< by odometry
    Scan scan;  ///< as if taken from where the robot is now; NaN where others have a hit already
    double share = 0.0;  ///< of the hits of all that are weighed together
  };
  void clear() { kept_.clear(); }
  /// Keeps the scan in place of the one before of its scanner. Allocates nothing once it has seen
  /// as many scanners with scans as long. O(beams).
  void keep(const Observation& observation);
  /// The others' scans, of the run and of the last half second, that were not taken before; those
  /// whose motion until now odometry does not tell are left out. They and this one count as taken.
  /// O(beams).
  [[nodiscard]] const std::vector<Companion*>& take(const Observation& now);
  /// Of all hits that were taken, those of `now`; 1 when it was alone.
  [[nodiscard]] double own_share() const { return own_share_; }

  /// For saved states; what take() makes is made anew.
  template <class Self, class Archive>
  static void state(Self& self, Archive& archive) {
    auto count = static_cast<std::uint64_t>(self.kept_.size());
    archive(count);
    if constexpr (Archive::kReads) {
      if (count > kMaxScanners) archive.fail("has more scanners than there can be");
      self.kept_.assign(count, {});
    }
    for (auto& kept : self.kept_) {
      auto& observation = kept.companion.observation;
      archive(observation.run);
      archive(observation.scan);
      archive(observation.odom_from_robot);
      archive(observation.has_odometry);
      archive(kept.is_fresh);
    }
  }

 private:
  /// More than a robot has: then it is a mounting that is measured anew with every scan.
  static constexpr std::size_t kMaxScanners = 8;
  static constexpr std::size_t kDirections = 72;
  struct Kept {
    Companion companion;
    bool is_fresh = true;
  };
  /// Leaves out what lies in covered directions.
  void leave_out_covered(Scan& scan) const;
  /// Its hits cover their directions from here on; returns how many there are.
  std::size_t cover(const Scan& scan);

  std::vector<Kept> kept_;
  std::vector<Companion*> taken_;
  std::array<bool, kDirections> is_covered_{};
  double own_share_ = 1.0;
};

}  // namespace strata::localization
