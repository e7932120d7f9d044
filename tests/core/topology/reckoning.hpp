// SPDX-License-Identifier: Apache-2.0
/// Drives of which only odometry is known.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/topology/evidence.hpp"
#include "tests/core/topology/junction_world.hpp"

namespace strata::topology::test_world {

/// Visits of a drive known by odometry: factors and dead reckoning.
struct Reckoning {
  std::vector<OdometryFactor> odometry;
  std::vector<double> densities;
  std::vector<Pose2> poses;
  explicit Reckoning(const Drive& drive) {
    for (std::size_t i = 0; i < drive.visits.size(); ++i) {
      densities.push_back(-9.0);
      poses.push_back(drive.visits[i].odom_from_robot);
      if (i == 0) continue;
      odometry.push_back(odometry_step(between(poses[i - 1], poses[i]),
                                       drive.visits[i].path_length_m, kLandmarkOdometryNoise));
    }
  }
  [[nodiscard]] Measurements first(std::size_t visits) const {
    return {std::span(odometry).first(visits - 1), std::span(densities).first(visits)};
  }
};

inline Reckoning small_square(std::uint64_t seed) {
  const std::vector<Junction> corners{
      {0.0, 0.0, 15}, {12.0, 0.0, 15}, {12.0, 12.0, 15}, {0.0, 12.0, 15}};
  return Reckoning(drive(corners, {0, 1, 2, 3, 0, 1, 2}, kLandmarkOdometryNoise, seed));
}

}  // namespace strata::topology::test_world
