// SPDX-License-Identifier: Apache-2.0
/// Floors cut into rooms at random: a second kind of building, so that what was chosen in the
/// offices of random_office.hpp can be shown elsewhere. The two share no code.
#pragma once

#include <cstdint>

#include "tools/simulate/scenario.hpp"

namespace strata::simulate {

struct RandomFloorOptions {
  int days = 4;
  double reach_m = 8.0;  ///< of the scanner
  int people = 2;
  bool has_new_boxes = false;  ///< on the last day boxes stand where none ever stood
};

/// A floor of 16 to 26 m by 11 to 17 m, cut in two again and again. Each cut leaves an open
/// passage; long ones have a door too, open or closed by the day, a third of them by the minute.
/// Rooms have furniture along their walls, and some a box that stands at one of two places or
/// nowhere. The robot goes from room to room through the open passages and back, with a scanner of
/// 270 degrees; people walk between neighbouring rooms.
[[nodiscard]] ScenarioConfig random_floor(std::uint64_t seed, const RandomFloorOptions& options);

}  // namespace strata::simulate
