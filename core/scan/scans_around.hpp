// SPDX-License-Identifier: Apache-2.0
/// The scans shortly before and after one, and what they say of its beams without return.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <tuple>

#include "core/geometry/pose2.hpp"
#include "core/scan/drop_out_tally.hpp"
#include "core/scan/range_limit.hpp"
#include "core/scan/scan.hpp"
#include "core/scan/seen_surfaces.hpp"

namespace strata {

/// Scans before and after that are asked, in scans of the same scanner: a surface that is dark or
/// slanted may return nothing for some of them.
inline constexpr std::array<std::size_t, 4> kStepsAround{1, 2, 4, 8};
/// Those further away are not asked.
inline constexpr double kAround_s = 3.0;
inline constexpr double kAround_m = 1.0;

/// What tells one scanner from another: its mounting, as in ScannerTurns, and its reach. Some send
/// other angles with each scan.
using ScannerKey = std::tuple<double, double, double, float>;
[[nodiscard]] inline ScannerKey scanner_of(const Scan& scan) {
  const Pose2& at = scan.robot_from_laser;
  return {at.x, at.y, at.theta, range_limit_m(scan.range_max_m)};
}
/// How far the scanner sees; 0: that is not told.
[[nodiscard]] inline double reach_of(const Scan& scan) {
  return tells_reach(scan.range_max_m) ? static_cast<double>(scan.range_max_m) : 0.0;
}

[[nodiscard]] inline bool has_no_return(const Scan& scan) {
  for (std::size_t beam = 0; beam < scan.size(); ++beam) {
    if (scan.kind(beam) == BeamKind::kNoReturn) return true;
  }
  return false;
}

/// The surfaces of some scans, in the beams of another.
class SurfacesAround {
 public:
  /// other(step): the scan so many before, or after; nullptr: there is none.
  template <typename Other>
  void lay(const PosedScan& scan, const Other& other) {
    count_ = 0;
    for (const std::size_t step : kStepsAround) {
      const PosedScan* one = other(step);
      if (one == nullptr || one->run != scan.run) return;
      const double apart_s = std::abs((one->scan.stamp - scan.scan.stamp).seconds());
      const double apart_m = translation_distance(one->map_from_robot, scan.map_from_robot);
      if (!(apart_s <= kAround_s) || !(apart_m <= kAround_m)) return;
      laid_[count_++].lay(scan.scan, inverse(scan.map_from_laser()) * one->map_from_laser(),
                          one->scan);
    }
  }
  [[nodiscard]] std::span<const SeenSurfaces> get() const { return std::span(laid_).first(count_); }

 private:
  std::array<SeenSurfaces, kStepsAround.size()> laid_;
  std::size_t count_ = 0;
};

/// Fewer neighbouring beams without return than this say nothing: a surface lost them, or a gap is
/// narrow.
inline constexpr std::size_t kMinInARow = 3;

/// Calls silent(beam), in order, for each beam without return that says nothing: those that are few
/// in a row, and those that would have met a surface that any scan around shows nearer than
/// `reach_m`. What only one before or one after shows has come or gone, or is of glass.
template <typename Silent>
void for_each_silent(const Scan& scan, std::span<const SeenSurfaces> before,
                     std::span<const SeenSurfaces> after, double reach_m, const Silent& silent) {
  const auto meets = [&](std::span<const SeenSurfaces> shown, std::size_t beam) {
    return std::any_of(shown.begin(), shown.end(), [&](const SeenSurfaces& one) {
      return static_cast<double>(one.range_m(beam)) < reach_m;
    });
  };
  std::size_t begin = 0;  // of those in a row
  for (std::size_t end = 0; end <= scan.size(); ++end) {
    if (end < scan.size() && scan.kind(end) == BeamKind::kNoReturn) continue;
    const bool are_few = end - begin < kMinInARow;
    for (std::size_t beam = begin; beam < end; ++beam) {
      if (are_few || meets(before, beam) || meets(after, beam)) {
        silent(static_cast<std::uint32_t>(beam));
      }
    }
    begin = end + 1;
  }
}

/// Counts the beams of a scan that has scans before and after: a return dropped out where both show
/// the surface. Nothing, and false, where one of the two is missing.
[[nodiscard]] inline bool judge_beams(const Scan& scan, std::span<const SeenSurfaces> before,
                                      std::span<const SeenSurfaces> after, double reach_m,
                                      DropOutTally& tally) {
  if (before.empty() || after.empty()) return false;
  for (std::size_t beam = 0; beam < scan.size(); ++beam) {
    const BeamKind kind = scan.kind(beam);
    if (kind != BeamKind::kHit && kind != BeamKind::kNoReturn) continue;
    const bool is_none = kind == BeamKind::kNoReturn;
    if (is_none) {
      tally.add_no_return();
    } else if (static_cast<double>(scan.ranges_m[beam]) > DropOutTally::kFar * reach_m) {
      tally.add_far();
    }
    const double share = static_cast<double>(surface_that_stays_m(beam, before, after)) / reach_m;
    if (share < DropOutTally::kTrusted) tally.add_surface(share, is_none);
  }
  return true;
}

}  // namespace strata
