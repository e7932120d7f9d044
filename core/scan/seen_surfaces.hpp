// SPDX-License-Identifier: Apache-2.0
/// Where the beams of one scan meet the surfaces that another one shows, without a map.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/geometry/pose2.hpp"
#include "core/scan/scan.hpp"

namespace strata {

/// Reused from scan to scan: allocates nothing once it has held the longest.
class SeenSurfaces {
 public:
  /// There is none.
  static constexpr float kNone = std::numeric_limits<float>::infinity();

  /// Lays the surfaces of `other` into the beams of `scan`. Hits that lie up to 0.3 m apart, with
  /// up to two beams without hit between them, are of one surface. O(beams of both).
  void lay(const Scan& scan, const Pose2& laser_from_other_laser, const Scan& other);

  /// Where a beam meets the nearest surface, if its neighbours meet the same one (up to 0.3 m
  /// nearer or farther): edges are told by noise. Else kNone.
  [[nodiscard]] float range_m(std::size_t beam) const;

 private:
  void lay_piece(const Scan& scan, const Eigen::Vector2d& a, const Eigen::Vector2d& b);
  std::vector<float> ranges_m_;  ///< a beam each
};

/// The nearest surface that a beam meets before and after: a pair of ranges up to 0.3 m apart, of
/// which the greater counts. SeenSurfaces::kNone: there is none.
[[nodiscard]] float surface_that_stays_m(std::size_t beam, std::span<const SeenSurfaces> before,
                                         std::span<const SeenSurfaces> after);

}  // namespace strata
