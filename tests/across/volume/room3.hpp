// SPDX-License-Identifier: Apache-2.0
/// A furnished room with people in space, and a scanner with several layers: what 3-D maps are
/// tested against. It shares no code with them.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/geometry/pose3.hpp"
#include "core/random/stream.hpp"

namespace strata::simulate {

/// An upright box [m].
struct Block {
  Eigen::Vector3d low;
  Eigen::Vector3d high;
};

/// An upright cylinder that walks to and fro along a path, and waits at both of its ends.
struct Walker {
  std::vector<Eigen::Vector2d> path;
  double speed_mps = 1.0;
  double wait_s = 3.0;
  double start_s = 0.0;  ///< how far into its walk it is at time 0
  double radius_m = 0.22;
  double height_m = 1.75;
};

struct Room3 {
  Block walls;  ///< the room is inside
  std::vector<Block> furniture;
  std::vector<Walker> people;
};

/// Layers of beams all around; one layer at elevation 0 is a 2-D scanner.
struct Scanner3 {
  int layers = 48;
  int beams = 360;
  double lowest_rad = -0.75;
  double highest_rad = 0.75;
  double noise_m = 0.01;
  double max_range_m = 30.0;
  double drop_rate = 0.005;
};

/// Points in the sensor's frame, layer by layer, and which lie on a person. Without return: NaN.
struct Sweep3 {
  std::vector<Eigen::Vector3f> points_m;
  std::vector<std::uint8_t> on_person;
};

/// Where a walker stands.
[[nodiscard]] Eigen::Vector2d place_of(const Walker& walker, double time_s);

/// One sweep at one moment. O(beams x (furniture + people)).
[[nodiscard]] Sweep3 sweep(const Room3& room, const Scanner3& scanner, const Pose3& map_from_sensor,
                           double time_s, RandomStream& random);

/// A room of about 10 x 8 x 3 m with tables and cupboards, and people on random ways; the middle
/// lane |y| < 0.6 m is free for the robot.
[[nodiscard]] Room3 random_room(std::uint64_t seed, int people);

}  // namespace strata::simulate
