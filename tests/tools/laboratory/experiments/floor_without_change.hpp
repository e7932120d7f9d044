// SPDX-License-Identifier: Apache-2.0
/// A world whose map is right: a drive through a floor in which nothing has changed.
#pragma once

#include "tools/laboratory/experiments/verdict_worlds.hpp"
#include "tools/simulate/random_floor.hpp"

namespace strata::experiments::test_floor {

inline const VerdictWorld& floor_without_change() {
  static const VerdictWorld world = [] {
    simulate::ScenarioConfig floor = simulate::random_floor(1, {.days = 2, .people = 0});
    floor.doors.clear();
    floor.boxes.clear();
    return world_of_scenario("floor", floor, 1);
  }();
  return world;
}

}  // namespace strata::experiments::test_floor
