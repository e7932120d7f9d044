// SPDX-License-Identifier: Apache-2.0
/// Buildings in which SLAM is hard: rooms that look alike along a ring or a long corridor, halls
/// with rows of pillars, floors cut at random; odometry is 5% off everywhere.
#pragma once

#include <cstdint>

#include "tools/simulate/scenario.hpp"

namespace strata::experiments {

/// A corridor 2.4 m wide around a court of 40 to 70 m by 15 to 30 m, with rooms of one size along
/// its outer wall, driven twice around. One room in five has a piece of furniture.
[[nodiscard]] simulate::ScenarioConfig ring_of_rooms(std::uint64_t seed);
/// A straight one of 60 to 110 m between two such rows, driven to its end and back.
[[nodiscard]] simulate::ScenarioConfig long_corridor(std::uint64_t seed);
/// A hall of 35 to 60 m by 25 to 40 m with rows of pillars and some stands, driven around twice and
/// across once; the scanner reaches 20 m.
[[nodiscard]] simulate::ScenarioConfig hall_of_pillars(std::uint64_t seed);
/// A floor of simulate::random_floor.
[[nodiscard]] simulate::ScenarioConfig poor_odometry_floor(std::uint64_t seed);

}  // namespace strata::experiments
