// SPDX-License-Identifier: Apache-2.0
#include "tools/simulate/simulation.hpp"

#include <algorithm>
#include <cmath>

#include "components/settings/settings.hpp"
#include "tools/simulate/people.hpp"
#include "tools/simulate/robot.hpp"
#include "tools/simulate/space_day.hpp"

namespace strata::simulate {
namespace {

/// The changeable segments at one moment.
std::vector<Segment> shapes_at(const std::vector<ChangeableObject>& objects, int day,
                               double time_s) {
  std::vector<Segment> segments;
  for (const ChangeableObject& object : objects) {
    const auto& shape = object.shapes[object.state_at(day, time_s)];
    segments.insert(segments.end(), shape.begin(), shape.end());
  }
  return segments;
}

/// Between two steps of a drive.
Pose2 pose_at(const std::vector<Pose2>& steps, double time_s) {
  const double at = time_s / kDriveStep_s;
  const auto step = std::min(static_cast<std::size_t>(at), steps.size() - 1);
  const std::size_t next = std::min(step + 1, steps.size() - 1);
  return interpolate(steps[step], steps[next],
                     std::clamp(at - static_cast<double>(step), 0.0, 1.0));
}

}  // namespace

ScenarioConfig load_scenario(const std::string& file, const std::vector<std::string>& overrides,
                             std::vector<std::string>* notes) {
  YAML::Node document = settings::load_document(file);
  settings::apply_overrides(document, overrides);
  return settings::read_config<ScenarioConfig>(document, file, {}, notes);
}

struct Simulator::State {
  Simulation base;
  std::vector<std::vector<Pose2>> true_poses;
  std::unique_ptr<World> world;
  int day = 0;
  double day_start_s = 0.0;
  Pose2 odom_start;
  std::uint64_t scan_index = 0;
};

Simulator::Simulator(const ScenarioConfig& scenario, std::uint64_t seed)
    : state_(std::make_unique<State>()) {
  require_valid(scenario, scenario.name);
  state_->base = {scenario, seed, {}, {}, {}};
  state_->day_start_s = scenario.start_s;
  Pose2 start = first_pose(scenario.robot);
  double longest_s = 0.0;
  for (int day = 1; day <= scenario.days; ++day) {
    state_->true_poses.push_back(drive(scenario.robot, start));
    const std::vector<Pose2>& poses = state_->true_poses.back();
    start = poses.back();
    longest_s = std::max(longest_s, static_cast<double>(poses.size()) * kDriveStep_s);
  }
  state_->world = std::make_unique<World>(scenario, seed, longest_s);
  state_->base.walls = state_->world->walls();
  state_->base.objects = state_->world->objects();
}

Simulator::~Simulator() = default;

const Simulation& Simulator::world() const { return state_->base; }

SimulatedDay Simulator::next_day(Progress* progress) {
  State& state = *state_;
  const ScenarioConfig& scenario = state.base.scenario;
  const std::uint64_t seed = state.base.seed;
  const int day = ++state.day;
  const double period_s = 1.0 / scenario.laser.rate_hz;
  const double day_start_s = state.day_start_s;
  const std::vector<Pose2>& truth = state.true_poses[static_cast<std::size_t>(day - 1)];
  const std::vector<Pose2> odom = odometry(scenario.robot, truth, state.odom_start, seed, day);
  state.odom_start = odom.back();
  const People people(scenario, seed, day);
  const double length_s = static_cast<double>(truth.size() - 1) * kDriveStep_s;
  const auto scans = static_cast<std::size_t>(length_s / period_s) + 1;
  SimulatedDay simulated;
  for (std::size_t i = 0; i < scans; ++i) {
    report_progress(progress, "simulate day " + std::to_string(day), i, scans);
    const double time_s = static_cast<double>(i) * period_s;
    SimulatedScan scan;
    scan.map_from_robot = pose_at(truth, time_s);
    const Pose2 map_from_laser = scan.map_from_robot * robot_from_laser(scenario.laser);
    const auto changeable = shapes_at(state.base.objects, day, time_s);
    const auto legs = people.legs_at(time_s, scan.map_from_robot.translation());
    RandomStream random(seed, StreamId::kSimulatorSensor, state.scan_index++);
    TrueScan taken =
        take_scan(scenario.laser, map_from_laser, {state.base.walls, changeable, legs}, random);
    // Whole milliseconds: text logs carry them exactly.
    taken.scan.stamp = Stamp::from_seconds(std::round((day_start_s + time_s) * 1e3) * 1e-3);
    scan.sources = std::move(taken.sources);
    scan.observation = {day - 1, std::move(taken.scan), pose_at(odom, time_s), true};
    simulated.scans.push_back(std::move(scan));
  }
  simulated.begin = simulated.scans.front().observation.scan.stamp;
  simulated.end = simulated.scans.back().observation.scan.stamp;
  const SpaceDay space_day{day,
                           day_start_s,
                           length_s,
                           [&](double time_s) { return pose_at(truth, time_s); },
                           &people,
                           state.base.walls,
                           state.world->first_block_side(),
                           state.base.objects};
  simulated.clouds = clouds_of(scenario, space_day, seed);
  simulated.images = images_of(scenario, space_day);
  state.day_start_s = std::ceil(day_start_s + length_s + scenario.night_s);
  return simulated;
}

Simulation simulate(const ScenarioConfig& scenario, std::uint64_t seed, Progress* progress) {
  Simulator simulator(scenario, seed);
  Simulation result = simulator.world();
  for (int day = 1; day <= scenario.days; ++day) {
    result.days.push_back(simulator.next_day(progress));
  }
  return result;
}

}  // namespace strata::simulate
