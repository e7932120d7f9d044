// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/put_object.hpp"

#include <cmath>

namespace strata::experiments {

simulate::Segment placed(const Board& board, const PosedScan& scan) {
  const Pose2 map_from_laser = scan.map_from_laser();
  const auto at = [&](double aside_m) {
    return (map_from_laser * Pose2{board.ahead_m, aside_m, 0.0}).translation();
  };
  return {at(-0.5 * board.width_m), at(0.5 * board.width_m)};
}

std::vector<PosedScan> with_object(std::span<const PosedScan> scans,
                                   const simulate::Segment& object, double noise_m,
                                   RandomStream& random) {
  std::vector<PosedScan> result(scans.begin(), scans.end());
  for (PosedScan& posed : result) {
    const Pose2 map_from_laser = posed.map_from_laser();
    for (std::size_t i = 0; i < posed.scan.ranges_m.size(); ++i) {
      const double bearing_rad = map_from_laser.theta + posed.scan.bearing_rad(i);
      const double hit_m = simulate::ray_to_segment(
          map_from_laser.translation(), {std::cos(bearing_rad), std::sin(bearing_rad)}, object);
      float& range_m = posed.scan.ranges_m[i];
      // A beam without an echo, Inf or NaN, passes the object's place as well.
      if (std::isinf(hit_m) || static_cast<double>(range_m) <= hit_m) continue;
      range_m = static_cast<float>(random.normal(hit_m, noise_m));
    }
  }
  return result;
}

}  // namespace strata::experiments
