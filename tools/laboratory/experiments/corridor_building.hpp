// SPDX-License-Identifier: Apache-2.0
/// Buildings of corridors whose crossings look alike, for topologies.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "tools/simulate/scenario.hpp"

namespace strata::experiments {

/// Crossings on a grid, joined by straight corridors between solid blocks. The i-th crossing is the
/// (i % columns)-th of row i / columns, from the south-west.
struct CorridorPlan {
  int columns = 3;
  int rows = 3;
  double spacing_x_m = 10.0;  ///< of crossings, from middle to middle
  double spacing_y_m = 10.0;
  double width_m = 2.0;  ///< of corridors
  /// Corridors that are walled off, by their two crossings, the lower first.
  std::vector<std::pair<std::size_t, std::size_t>> closed;
  std::vector<std::size_t> route;  ///< crossings, each beside the one before

  [[nodiscard]] std::size_t crossings() const {
    return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  }
  [[nodiscard]] bool is_open(std::size_t a, std::size_t b) const;
  /// Where open corridors lead from a crossing, ascending.
  [[nodiscard]] std::vector<std::size_t> beside(std::size_t crossing) const;
};

/// How wrong wheels count: `share` of the way driven, by a scale of the day and by the metre, and a
/// fifth of it of the angle turned.
void set_odometry_error(simulate::RobotConfig& robot, double share);

/// The building and the drive along its route, one day. Errors of the odometry are the defaults.
/// Throws ConfigError for a route along a corridor that is none.
[[nodiscard]] simulate::ScenarioConfig corridor_building(const CorridorPlan& plan);

/// 9 to 15 crossings 6.5 to 9 m apart, the same everywhere, so that crossings of as many corridors
/// cannot be told apart; some corridors are walled off. The robot drives at random past 14 to 20
/// of them, back only out of dead ends.
[[nodiscard]] CorridorPlan random_corridors(std::uint64_t seed);

}  // namespace strata::experiments
