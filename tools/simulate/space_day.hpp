// SPDX-License-Identifier: Apache-2.0
/// What the 3-D scanner and the camera of a robot see on one simulated day.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "core/geometry/pose2.hpp"
#include "tools/simulate/people.hpp"
#include "tools/simulate/space.hpp"

namespace strata::simulate {

/// A day as far as it matters here.
struct SpaceDay {
  int day = 1;
  double start_s = 0.0;                         ///< stamp of its begin
  double length_s = 0.0;                        ///< from its begin to its end
  std::function<Pose2(double)> map_from_robot;  ///< at a time of the day
  const People* people = nullptr;
  std::span<const Segment> still;
  std::size_t first_block_side = 0;
  std::span<const ChangeableObject> objects;
};

/// Clouds whose sweep is over before the day is. Streams of random numbers are the day's own.
[[nodiscard]] std::vector<SimulatedCloud> clouds_of(const ScenarioConfig& scenario,
                                                    const SpaceDay& day, std::uint64_t seed);
[[nodiscard]] std::vector<SimulatedImage> images_of(const ScenarioConfig& scenario,
                                                    const SpaceDay& day);

}  // namespace strata::simulate
