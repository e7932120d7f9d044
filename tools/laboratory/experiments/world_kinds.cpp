// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/world_kinds.hpp"

#include "tools/simulate/random_floor.hpp"
#include "tools/simulate/random_office.hpp"
#include "tools/simulate/simulation.hpp"

namespace strata::experiments {
namespace {

constexpr double kShortReach_m = 4.0;
constexpr int kDays = 4;

/// Learned closed and open; the robot drives along all of the corridor.
simulate::ScenarioConfig decisive_door(const std::string& file, const char* state) {
  simulate::ScenarioConfig scenario = simulate::load_scenario(file);
  scenario.days = 3;
  scenario.doors.front().states.schedule.push_back({3, 0.0, state});
  return scenario;
}

simulate::ScenarioConfig office(std::uint64_t seed) {
  return simulate::random_office(seed, {kDays, true, 2});
}

}  // namespace

std::vector<WorldKind> kinds_of_worlds(const std::string& scenarios) {
  using simulate::random_floor;
  std::vector<WorldKind> kinds{{"offices, 4 m",
                                [](std::uint64_t seed) {
                                  simulate::ScenarioConfig short_sighted = office(seed);
                                  short_sighted.laser.range_max_m = kShortReach_m;
                                  return short_sighted;
                                }},
                               {"offices, 12 m", office},
                               {"floors, 4 m",
                                [](std::uint64_t seed) {
                                  return random_floor(seed, {kDays, kShortReach_m});
                                }},
                               {"floors, 8 m",
                                [](std::uint64_t seed) {
                                  return random_floor(seed, {kDays, 8.0});
                                }},
                               {"floors with new boxes, 4 m", [](std::uint64_t seed) {
                                  return random_floor(seed, {kDays, kShortReach_m, 2, true});
                                }}};
  for (const char* state : {"closed", "open"}) {
    kinds.push_back({std::string("decisive door, ") + state,
                     [door = decisive_door(scenarios + "/side_door.yaml", state)](std::uint64_t) {
                       return door;
                     }});
  }
  return kinds;
}

}  // namespace strata::experiments
