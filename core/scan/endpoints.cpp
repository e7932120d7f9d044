// SPDX-License-Identifier: Apache-2.0
#include "core/scan/endpoints.hpp"

#include <cmath>

namespace strata {

Endpoints endpoints_in_robot(const Scan& scan) {
  Endpoints result;
  result.x_m.reserve(scan.size());
  result.y_m.reserve(scan.size());
  result.beam.reserve(scan.size());
  for (std::size_t beam = 0; beam < scan.size(); ++beam) {
    if (scan.kind(beam) != BeamKind::kHit) continue;
    const double range_m = static_cast<double>(scan.ranges_m[beam]);
    const double bearing = scan.bearing_rad(beam);
    const Eigen::Vector2d point =
        scan.robot_from_laser *
        Eigen::Vector2d(range_m * std::cos(bearing), range_m * std::sin(bearing));
    result.x_m.push_back(point.x());
    result.y_m.push_back(point.y());
    result.beam.push_back(static_cast<std::uint32_t>(beam));
  }
  return result;
}

Endpoints subsample(const Endpoints& endpoints, std::size_t max_beams) {
  if (max_beams == 0 || endpoints.size() <= max_beams) return endpoints;
  Endpoints result;
  for (std::size_t i = 0; i < max_beams; ++i) {
    const std::size_t from = i * endpoints.size() / max_beams;
    result.x_m.push_back(endpoints.x_m[from]);
    result.y_m.push_back(endpoints.y_m[from]);
    result.beam.push_back(endpoints.beam[from]);
  }
  return result;
}

}  // namespace strata
