// SPDX-License-Identifier: Apache-2.0
/// Simulated buildings of several levels with a lift, and rides in it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "components/maps/maps_folder.hpp"
#include "core/localization/level_localizer.hpp"
#include "core/scan/scan.hpp"
#include "tools/simulate/scenario.hpp"
#include "tools/simulate/world.hpp"

namespace strata::experiments {

struct LiftFloor {
  simulate::ScenarioConfig scenario;
  std::vector<simulate::Segment> walls;  ///< without the lift's door
  maps::Maps maps;
};

/// Levels of one building in one frame; the lift is at the origin on each.
struct LiftBuilding {
  std::vector<LiftFloor> floors;
  std::size_t first_twin = 0;  ///< this level and the last one look alike
  bool has_twins = false;      ///< ... everywhere; else but for the ends of their corridors
  [[nodiscard]] bool are_twins(std::size_t a, std::size_t b) const;
};

/// A corridor 2.2 m wide with rooms on both sides, and a lift of 1.8 m by 2 m with a sliding door.
[[nodiscard]] simulate::ScenarioConfig lift_floor(std::uint64_t near_seed, std::uint64_t far_seed);
/// Three to five floors, each mapped in two drives, the lift's door open for a part of each.
[[nodiscard]] LiftBuilding lift_building(std::uint64_t seed);

/// The cabin, in which every level is possible.
[[nodiscard]] localization::Lift lift_of(const LiftBuilding& building);

/// One scan of a ride.
struct RideScan {
  Observation observation;
  Pose2 truth;
  std::size_t level = 0;          ///< true one
  bool is_opening = false;        ///< the door has begun to open at the end of the ride
  double least_difference = 0.0;  ///< of all levels that are no twin, the least share of
                                  ///< beams that would be another length there
};

struct Ride {
  std::size_t from = 0;
  std::size_t to = 0;
  bool has_people = false;  ///< somebody stands in the door when it opens
  std::vector<RideScan> scans;
};

/// From the corridor into the lift, a ride of 5 to 15 s (or none, when `to` is `from`), and out
/// along the corridor, in which up to two boxes stand that nobody mapped.
[[nodiscard]] Ride ride(const LiftBuilding& building, std::size_t from, std::size_t to,
                        std::uint64_t seed);

}  // namespace strata::experiments
