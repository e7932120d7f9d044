// SPDX-License-Identifier: Apache-2.0
/// The simulated scanner.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/random/stream.hpp"
#include "core/scan/scan.hpp"
#include "tools/simulate/scenario.hpp"
#include "tools/simulate/world.hpp"

namespace strata::simulate {

/// What a beam truly ended in.
enum class BeamSource : std::uint8_t {
  kNothing,     ///< nothing within reach, or dropped
  kStill,       ///< a wall or furniture
  kChangeable,  ///< a door or a box
  kPerson,
  kOutlier,  ///< an invented short range
};

/// A scan with the truth of each beam.
struct TrueScan {
  Scan scan;
  std::vector<BeamSource> sources;
};

/// What there is to hit at one moment.
struct Surroundings {
  std::span<const Segment> still;
  std::span<const Segment> changeable;
  std::span<const Circle> people;
};

/// One scan from the true pose of the laser. Ranges get normal noise; from range_max on, and when
/// dropped, a beam is +Inf. O(beams x obstacles).
[[nodiscard]] TrueScan take_scan(const LaserConfig& config, const Pose2& map_from_laser,
                                 const Surroundings& surroundings, RandomStream& random);

/// Where the laser sits on the robot.
[[nodiscard]] Pose2 robot_from_laser(const LaserConfig& config);

}  // namespace strata::simulate
