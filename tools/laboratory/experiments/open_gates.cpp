// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/open_gates.hpp"

#include <algorithm>
#include <array>

#include "core/random/stream.hpp"
#include "tools/simulate/simulation.hpp"

namespace strata::experiments {
namespace {

constexpr int kGateDays = 6;
constexpr double kReach_m = 8.0;

struct Hall {
  simulate::ScenarioConfig scenario;
  std::array<double, 4> opening;  ///< x0, y0, x1, y1 in the north wall
};

Hall draw_hall(RandomStream& random) {
  const double length = random.uniform(9.0, 15.0);
  const double width = random.uniform(6.0, 9.0);
  const double opening = random.uniform(2.0, 3.5);
  const double from = random.uniform(1.0, length - opening - 1.0);
  Hall hall{{}, {from, width, from + opening, width}};
  simulate::ScenarioConfig& scenario = hall.scenario;
  scenario.days = kGateDays;
  scenario.walls.push_back({{0.0, width, 0.0, 0.0, length, 0.0, length, width}});
  scenario.walls.push_back({{0.0, width, from, width}});
  scenario.walls.push_back({{from + opening, width, length, width}});
  // Pillars and cupboards along the south wall.
  for (double x = random.uniform(0.5, 2.0); x + 1.0 < length; x += random.uniform(2.0, 4.0)) {
    scenario.blocks.push_back({{x, 0.0, x + random.uniform(0.3, 1.0), random.uniform(0.3, 0.8)}});
  }
  simulate::PersonConfig person;
  person.path = {1.0, width - 0.8, length - 1.0, width - random.uniform(0.8, 2.0)};
  person.speed_mps = random.uniform(0.6, 1.1);
  scenario.people = {person};
  const double south = random.uniform(1.6, 2.2);
  const double north = width - random.uniform(1.5, 2.5);
  scenario.robot.route = {1.2,   south, length - 1.2, south, length - 1.2,
                          north, 1.2,   north,        1.2,   south};
  scenario.laser.range_max_m = kReach_m;
  scenario.laser.drop_probability = random.uniform(0.0, 0.01);
  scenario.laser.field_of_view_deg = random.bernoulli(0.5) ? 180.0 : 270.0;
  return hall;
}

}  // namespace

simulate::ScenarioConfig hall_with_gate(std::uint64_t seed) {
  RandomStream random(seed, StreamId::kTest, 79);
  Hall hall = draw_hall(random);
  simulate::DoorConfig gate;
  gate.id = "gate";
  gate.kind = simulate::DoorKind::kSliding;
  gate.at.assign(hall.opening.begin(), hall.opening.end());
  int open_left = kGateDays / 2;
  for (int day = 1; day <= kGateDays; ++day) {
    const int left = kGateDays + 1 - day;
    const bool is_open =
        static_cast<int>(random.below(static_cast<std::uint32_t>(left))) < open_left;
    if (is_open) --open_left;
    gate.states.schedule.push_back({day, 0.0, is_open ? "open" : "closed"});
  }
  hall.scenario.doors.push_back(gate);
  hall.scenario.name = "hall_with_gate";
  return std::move(hall.scenario);
}

simulate::ScenarioConfig hall_with_glass(std::uint64_t seed) {
  RandomStream random(seed, StreamId::kTest, 80);
  Hall hall = draw_hall(random);
  simulate::WallConfig glass;
  glass.points.assign(hall.opening.begin(), hall.opening.end());
  glass.glass_deg = random.uniform(8.0, 25.0);
  hall.scenario.walls.push_back(glass);
  hall.scenario.name = "hall_with_glass";
  return std::move(hall.scenario);
}

Judgement learn_hall(const simulate::ScenarioConfig& hall, std::uint64_t seed,
                     const PoseNoise& noise) {
  const simulate::Simulation simulation = simulate::simulate(hall, seed);
  const std::vector<PosedScan> scans = noisy_scans(simulation, noise, seed, 1, hall.days);
  return judge(simulation, learn_patches(scans, static_maps(scans).filtered));
}

}  // namespace strata::experiments
