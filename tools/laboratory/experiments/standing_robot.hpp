// SPDX-License-Identifier: Apache-2.0
/// A robot that stands in a corridor and watches a door while people linger.
#pragma once

#include <cstdint>

#include "tools/laboratory/experiments/simulated_maps.hpp"

namespace strata::experiments {

/// The corridor of a random office: the robot stands 1 to 3 m from a door, which begins open or
/// closed by chance and is moved `toggles` times, 45 to 150 s apart; nothing else changes. Two
/// people come and go and rest for 20 s at a time, one of them before the door.
[[nodiscard]] simulate::Simulation stand_before_door(std::uint64_t seed, int toggles);

/// What the log learner makes of it.
[[nodiscard]] Judgement standing_robot(std::uint64_t seed, int toggles, const PoseNoise& noise);

/// What the learner that takes one scan after the other makes of it.
[[nodiscard]] Judgement standing_robot_online(std::uint64_t seed, int toggles,
                                              const PoseNoise& noise);

}  // namespace strata::experiments
