// SPDX-License-Identifier: Apache-2.0
/// End points of a scan's hits as structure of arrays.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/scan/scan.hpp"

namespace strata {

/// The hits of one scan: x[i], y[i] in metres in the frame they were asked for, beam[i] the index
/// of the beam. All three have equal length; beams that hit nothing are left out.
struct Endpoints {
  std::vector<double> x_m;
  std::vector<double> y_m;
  std::vector<std::uint32_t> beam;

  [[nodiscard]] std::size_t size() const { return beam.size(); }
  [[nodiscard]] Eigen::Vector2d point_m(std::size_t i) const { return {x_m[i], y_m[i]}; }
};

/// Hits in the robot frame. O(beams).
[[nodiscard]] Endpoints endpoints_in_robot(const Scan& scan);

/// Those of which keep(i) holds, in their order, same frame. O(hits).
template <class Keep>
[[nodiscard]] Endpoints those_of(const Endpoints& endpoints, const Keep& keep) {
  Endpoints result;
  for (std::size_t i = 0; i < endpoints.size(); ++i) {
    if (!keep(i)) continue;
    result.x_m.push_back(endpoints.x_m[i]);
    result.y_m.push_back(endpoints.y_m[i]);
    result.beam.push_back(endpoints.beam[i]);
  }
  return result;
}

/// At most max_beams hits, spread evenly over the hits (every k-th by index), same frame. max_beams
/// 0 means all.
[[nodiscard]] Endpoints subsample(const Endpoints& endpoints, std::size_t max_beams);

}  // namespace strata
