// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/standing_robot.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/patch/online_learner.hpp"
#include "core/random/stream.hpp"
#include "tools/simulate/people.hpp"
#include "tools/simulate/random_office.hpp"

namespace strata::experiments {
namespace {

constexpr double kPause_s = 20.0;
/// A random office's corridor lies between these.
constexpr double kSouth_m = 4.5;
constexpr double kNorth_m = 6.7;

struct Scene {
  simulate::ScenarioConfig scenario;
  Pose2 map_from_robot;
  double length_s = 0.0;
};

/// When the door is in which state.
double schedule(RandomStream& random, int toggles, simulate::StateConfig& states) {
  bool is_open = random.bernoulli(0.5);
  double at_s = 0.0;
  for (int i = 0; i <= toggles; ++i) {
    states.schedule.push_back({1, at_s, is_open ? "open" : "closed"});
    at_s += random.uniform(45.0, 150.0);
    is_open = !is_open;
  }
  return at_s;
}

Scene draw_scene(std::uint64_t seed, int toggles) {
  RandomStream random(seed, StreamId::kTest, 78);
  Scene scene;
  scene.scenario = simulate::random_office(seed, {1, false, 0});
  scene.scenario.boxes.clear();  // they may hide the door
  auto& doors = scene.scenario.doors;
  simulate::DoorConfig& door = doors[random.below(static_cast<std::uint32_t>(doors.size()))];
  scene.length_s = schedule(random, toggles, door.states);
  const double x = 0.5 * (door.at[0] + door.at[2]);
  const double y = door.at[1];
  const bool is_south = y < 0.5 * (kSouth_m + kNorth_m);
  const double inwards = is_south ? 1.0 : -1.0;  // into the corridor
  const double away_m = random.uniform(1.0, 1.7);
  const double beside_m = random.uniform(0.0, 2.4) * (random.bernoulli(0.5) ? 1.0 : -1.0);
  const Eigen::Vector2d at(std::max(0.6, x + beside_m), y + inwards * away_m);
  scene.map_from_robot = {at.x(), at.y(),
                          std::atan2(y - at.y(), x - at.x()) + random.uniform(-0.5, 0.5)};
  simulate::PersonConfig visitor;
  const double middle = 0.5 * (kSouth_m + kNorth_m);
  visitor.path = {x, y + inwards * random.uniform(0.3, 0.7), x + 6.0, middle};
  visitor.pause_s = kPause_s;
  simulate::PersonConfig passer;
  passer.path = {std::max(0.5, x - 3.0), kNorth_m - 0.6, x + 3.0, kSouth_m + 0.6};
  passer.pause_s = kPause_s;
  scene.scenario.people = {visitor, passer};
  return scene;
}

std::vector<simulate::Segment> shapes_at(const std::vector<simulate::ChangeableObject>& objects,
                                         double time_s) {
  std::vector<simulate::Segment> segments;
  for (const simulate::ChangeableObject& object : objects) {
    const auto& shape = object.shapes[object.state_at(1, time_s)];
    segments.insert(segments.end(), shape.begin(), shape.end());
  }
  return segments;
}

}  // namespace

simulate::Simulation stand_before_door(std::uint64_t seed, int toggles) {
  const Scene scene = draw_scene(seed, toggles);
  const simulate::World world(scene.scenario, seed, scene.length_s);
  const simulate::People people(scene.scenario, seed, 1);
  simulate::Simulation result{scene.scenario, seed, world.walls(), world.objects(), {}};
  simulate::SimulatedDay day;
  const simulate::LaserConfig& laser = scene.scenario.laser;
  const Pose2 map_from_laser = scene.map_from_robot * simulate::robot_from_laser(laser);
  const auto scans = static_cast<std::uint64_t>(scene.length_s * laser.rate_hz);
  for (std::uint64_t i = 0; i < scans; ++i) {
    const double time_s = static_cast<double>(i) / laser.rate_hz;
    const auto changeable = shapes_at(result.objects, time_s);
    const auto legs = people.legs_at(time_s, scene.map_from_robot.translation());
    RandomStream random(seed, StreamId::kSimulatorSensor, i);
    simulate::TrueScan taken =
        simulate::take_scan(laser, map_from_laser, {result.walls, changeable, legs}, random);
    taken.scan.stamp = Stamp::from_seconds(scene.scenario.start_s + time_s);
    day.scans.push_back({{0, std::move(taken.scan), scene.map_from_robot, true},
                         scene.map_from_robot,
                         std::move(taken.sources)});
  }
  day.begin = day.scans.front().observation.scan.stamp;
  day.end = day.scans.back().observation.scan.stamp;
  result.days.push_back(std::move(day));
  return result;
}

Judgement standing_robot(std::uint64_t seed, int toggles, const PoseNoise& noise) {
  const simulate::Simulation simulation = stand_before_door(seed, toggles);
  const std::vector<PosedScan> scans = noisy_scans(simulation, noise, seed, 1, 1);
  return judge(simulation, learn_patches(scans, static_maps(scans).filtered));
}

Judgement standing_robot_online(std::uint64_t seed, int toggles, const PoseNoise& noise) {
  const simulate::Simulation simulation = stand_before_door(seed, toggles);
  const std::vector<PosedScan> scans = noisy_scans(simulation, noise, seed, 1, 1);
  patch::OnlinePatchLearner learner({}, {}, static_maps(scans).filtered);
  for (const PosedScan& scan : scans) (void)learner.add(scan);
  return judge(simulation, learner.finish());
}

}  // namespace strata::experiments
