// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/lift_building.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "core/geometry/angle.hpp"
#include "core/random/stream.hpp"
#include "tools/laboratory/experiments/simulated_maps.hpp"
#include "tools/simulate/laser.hpp"
#include "tools/simulate/robot.hpp"
#include "tools/simulate/simulation.hpp"

namespace strata::experiments {
namespace {

using simulate::ScenarioConfig;
using simulate::Segment;

constexpr double kCorridor_m = 2.2;
constexpr double kCabinHalf_m = 0.9;
constexpr double kCabinDepth_m = 2.0;
constexpr double kDoorHalf_m = 0.5;
constexpr double kOfficeDoor_m = 0.9;
constexpr double kLiftLobby_m = 6.0;  // of the lift: floors that look alike are the same within
constexpr double kMiddle_m = 0.5 * kCorridor_m;
constexpr double kScans_hz = 10.0;
constexpr float kDiffers_m = 0.3F;

void wall(ScenarioConfig& floor, std::vector<double> points) {
  floor.walls.push_back({std::move(points)});
}

/// Rooms along one side of the corridor from x0 outwards to x1; y: of the corridor's wall, out: the
/// direction away from the corridor.
void add_rooms(ScenarioConfig& floor, double x0, double x1, double y, double out,
               std::uint64_t near_seed, std::uint64_t far_seed) {
  RandomStream near(near_seed, StreamId::kTest, out > 0.0 ? 1 : 2, x1 > x0 ? 1U : 2U);
  RandomStream far(far_seed, StreamId::kTest, out > 0.0 ? 3 : 4, x1 > x0 ? 1U : 2U);
  const double side = x1 > x0 ? 1.0 : -1.0;
  double x = x0;
  while (side * (x1 - x) > 0.5) {
    RandomStream& random = std::abs(x) < kLiftLobby_m ? near : far;
    const double width = std::min(random.uniform(3.0, 5.5), side * (x1 - x));
    const double depth = random.uniform(2.5, 5.0);
    const double end = x + side * width;
    const double door = x + side * random.uniform(0.5, std::max(0.6, width - 1.5));
    const double back = y + out * depth;
    wall(floor, {x, y, x, back, end, back, end, y});
    if (random.bernoulli(0.6) && width > 2.0) {
      wall(floor, {x, y, door, y});
      wall(floor, {door + side * kOfficeDoor_m, y, end, y});
    } else {
      wall(floor, {x, y, end, y});
    }
    const double at = x + side * random.uniform(0.3, std::max(0.4, width - 1.3));
    const double deep = random.uniform(0.4, 0.9);
    floor.blocks.push_back({{std::min(at, at + side), std::min(back, back - out * deep),
                             std::max(at, at + side), std::max(back, back - out * deep)}});
    if (random.bernoulli(0.3)) {  // a cabinet in the corridor, in front of the wall
      const double c = end - side * 0.4;
      floor.blocks.push_back({{std::min(c, c - side * 0.6), std::min(y, y - out * 0.35),
                               std::max(c, c - side * 0.6), std::max(y, y - out * 0.35)}});
    }
    x = end;
  }
}

std::vector<Pose2> turned(const Pose2& from, double by_rad, double rate_rps) {
  std::vector<Pose2> poses;
  const int steps = static_cast<int>(std::abs(by_rad) / rate_rps / simulate::kDriveStep_s);
  for (int i = 1; i <= steps; ++i) {
    poses.push_back({from.x, from.y, wrap_angle(from.theta + by_rad * i / steps)});
  }
  return poses;
}

Segment leaf(double open) {
  return {{-kDoorHalf_m + 2.0 * kDoorHalf_m * open, 0.0}, {kDoorHalf_m, 0.0}};
}

/// When the door is how far open.
struct DoorPlan {
  double closes_s = 0.0;
  double opens_s = 0.0;
  [[nodiscard]] double open(double t) const {
    constexpr double kMoves_s = 2.0;
    if (t < opens_s) return 1.0 - std::clamp((t - closes_s) / kMoves_s, 0.0, 1.0);
    return std::clamp((t - opens_s) / kMoves_s, 0.0, 1.0);
  }
};

simulate::LaserConfig laser() {
  simulate::LaserConfig config;
  config.beams = 270;
  config.field_of_view_deg = 270.0;
  config.rate_hz = kScans_hz;
  config.range_max_m = 25.0;
  return config;
}

struct Track {
  std::vector<Pose2> poses;  // every drive step
  DoorPlan door;
};

Track track_of(RandomStream& random, simulate::RobotConfig robot) {
  Track track;
  const double from = random.bernoulli(0.5) ? 4.0 : -4.0;
  robot.route = {0.0, kMiddle_m, 0.0, -1.1};
  track.poses = simulate::drive(robot, {from, kMiddle_m, from > 0.0 ? std::numbers::pi : 0.0});
  const auto append = [&](const std::vector<Pose2>& more) {
    track.poses.insert(track.poses.end(), more.begin(), more.end());
  };
  const auto stand = [&](double s) {
    append(std::vector<Pose2>(static_cast<std::size_t>(s / simulate::kDriveStep_s),
                              track.poses.back()));
  };
  const auto now = [&] { return static_cast<double>(track.poses.size()) * simulate::kDriveStep_s; };
  append(turned(track.poses.back(), random.bernoulli(0.5) ? std::numbers::pi : -std::numbers::pi,
                robot.turn_rate_rps));
  stand(random.uniform(0.5, 3.0));
  track.door.closes_s = now();
  stand(2.0 + random.uniform(5.0, 15.0));
  track.door.opens_s = now();
  stand(2.0 + random.uniform(0.5, 3.0));
  const double to = random.bernoulli(0.5) ? 10.0 : -10.0;
  robot.route = {0.0, kMiddle_m, to, kMiddle_m};
  append(simulate::drive(robot, track.poses.back()));
  return track;
}

/// Somebody stands in front of the lift, lets the door open, and walks away to a side.
std::vector<simulate::Circle> legs_at(double s, double x) {
  const double aside = std::max(0.0, s - 4.0) * 0.8;
  return {{{x + aside, 0.6}, 0.07}, {{x + 0.24 + aside, 0.65}, 0.07}};
}

/// Up to two boxes along the corridor near the lift, which nobody mapped.
std::vector<Segment> new_boxes(RandomStream& random) {
  std::vector<Segment> sides;
  for (std::uint32_t count = random.below(3); count > 0; --count) {
    const double x = random.uniform(1.2, kLiftLobby_m) * (random.bernoulli(0.5) ? 1.0 : -1.0);
    const double y = random.bernoulli(0.5) ? 0.05 : kCorridor_m - 0.45;
    const Eigen::Vector2d a(x, y);
    const Eigen::Vector2d b(x + random.uniform(0.3, 0.8), y);
    const Eigen::Vector2d up(0.0, 0.4);
    sides.insert(sides.end(), {{a, b}, {b, b + up}, {b + up, a + up}, {a + up, a}});
  }
  return sides;
}

}  // namespace

bool LiftBuilding::are_twins(std::size_t a, std::size_t b) const {
  const std::size_t last = floors.size() - 1;
  return has_twins && std::min(a, b) == first_twin && std::max(a, b) == last;
}

ScenarioConfig lift_floor(std::uint64_t near_seed, std::uint64_t far_seed) {
  RandomStream far(far_seed, StreamId::kTest, 5);
  ScenarioConfig floor;
  const double west = -far.uniform(11.0, 15.0);
  const double east = far.uniform(11.0, 15.0);
  wall(floor, {west, 0.0, west, kCorridor_m});
  wall(floor, {east, 0.0, east, kCorridor_m});
  add_rooms(floor, 0.0, east, kCorridor_m, 1.0, near_seed, far_seed);
  add_rooms(floor, 0.0, west, kCorridor_m, 1.0, near_seed, far_seed);
  add_rooms(floor, kCabinHalf_m, east, 0.0, -1.0, near_seed, far_seed);
  add_rooms(floor, -kCabinHalf_m, west, 0.0, -1.0, near_seed, far_seed);
  wall(floor, {-kCabinHalf_m, 0.0, -kCabinHalf_m, -kCabinDepth_m, kCabinHalf_m, -kCabinDepth_m,
               kCabinHalf_m, 0.0});
  wall(floor, {-kCabinHalf_m, 0.0, kCabinHalf_m, 0.0});
  simulate::DoorConfig door;
  door.id = "lift";
  door.kind = simulate::DoorKind::kSliding;
  door.at = {-kDoorHalf_m, 0.0, kDoorHalf_m, 0.0};
  door.states.schedule = {{0, 0.0, "open"}, {0, 30.0, "closed"}};
  floor.doors.push_back(door);
  floor.days = 2;
  floor.laser = laser();
  floor.laser.rate_hz = 5.0;
  floor.robot.route = {0.0,       -1.1,       0.0,       kMiddle_m, west + 1.0,
                       kMiddle_m, east - 1.0, kMiddle_m, 3.0,       kMiddle_m};
  return floor;
}

LiftBuilding lift_building(std::uint64_t seed) {
  LiftBuilding building;
  const std::size_t count = 3 + seed % 3;
  building.has_twins = seed % 5 == 0;
  for (std::size_t level = 0; level < count; ++level) {
    const std::uint64_t own = 100 * seed + level;
    const bool is_alike = level + 1 == count;
    LiftFloor floor;
    floor.scenario =
        lift_floor(is_alike ? 100 * seed : own, is_alike && building.has_twins ? 100 * seed : own);
    const simulate::Simulation simulation = simulate::simulate(floor.scenario, own + 50);
    floor.walls = simulation.walls;
    const auto scans = noisy_scans(simulation, kGoodPoses, own + 50, 1, floor.scenario.days);
    const StaticMaps maps = static_maps(scans);
    floor.maps.occupancy = maps.occupancy;
    floor.maps.filtered = maps.filtered;
    floor.maps.patches = learn_patches(scans, maps.filtered);
    building.floors.push_back(std::move(floor));
  }
  return building;
}

localization::Lift lift_of(const LiftBuilding& building) {
  localization::Lift lift;
  lift.shape.push_back({{{-kCabinHalf_m, -kCabinDepth_m},
                         {kCabinHalf_m, -kCabinDepth_m},
                         {kCabinHalf_m, 0.0},
                         {-kCabinHalf_m, 0.0}},
                        {}});
  for (std::size_t level = 0; level < building.floors.size(); ++level) lift.levels.push_back(level);
  return lift;
}

Ride ride(const LiftBuilding& building, std::size_t from, std::size_t to, std::uint64_t seed) {
  RandomStream random(seed, StreamId::kTest, 6);
  Ride ride;
  ride.from = from;
  ride.to = to;
  ride.has_people = random.bernoulli(0.3);
  const double person_x = random.uniform(-0.4, 0.1);
  const simulate::RobotConfig robot;
  const Track track = track_of(random, robot);
  const std::vector<Segment> boxes = new_boxes(random);
  const auto odometry = simulate::odometry(robot, track.poses, {}, seed, 1);
  const simulate::LaserConfig noisy = laser();
  simulate::LaserConfig exact = noisy;
  exact.noise_m = exact.drop_probability = 0.0;
  const auto every = static_cast<std::size_t>(1.0 / kScans_hz / simulate::kDriveStep_s);
  for (std::size_t i = 0; i < track.poses.size(); i += every) {
    const double t = static_cast<double>(i) * simulate::kDriveStep_s;
    const bool has_ridden = t >= 0.5 * (track.door.closes_s + 2.0 + track.door.opens_s);
    RideScan scan;
    scan.level = has_ridden ? to : from;
    scan.truth = track.poses[i];
    scan.is_opening = t >= track.door.opens_s;
    std::vector<Segment> door{leaf(std::min(track.door.open(t), 0.999))};
    if (has_ridden) door.insert(door.end(), boxes.begin(), boxes.end());
    std::vector<simulate::Circle> people;
    if (ride.has_people && scan.is_opening) people = legs_at(t - track.door.opens_s, person_x);
    const Pose2 laser_pose = scan.truth * simulate::robot_from_laser(noisy);
    scan.observation = {
        0,
        simulate::take_scan(noisy, laser_pose, {building.floors[scan.level].walls, door, people},
                            random)
            .scan,
        odometry[i], true};
    scan.observation.scan.stamp = Stamp::from_seconds(1000.0 + t);
    if (scan.is_opening) {
      const auto truly = [&](std::size_t level) {
        RandomStream none(1, StreamId::kTest);
        return simulate::take_scan(exact, laser_pose, {building.floors[level].walls, door, people},
                                   none)
            .scan.ranges_m;
      };
      const auto here = truly(scan.level);
      scan.least_difference = 1.0;
      for (std::size_t level = 0; level < building.floors.size(); ++level) {
        if (level == scan.level || building.are_twins(level, scan.level)) continue;
        const auto there = truly(level);
        std::size_t differ = 0;
        for (std::size_t k = 0; k < here.size(); ++k) {
          if (!(std::abs(here[k] - there[k]) < kDiffers_m) && here[k] != there[k]) ++differ;
        }
        scan.least_difference = std::min(
            scan.least_difference, static_cast<double>(differ) / static_cast<double>(here.size()));
      }
    }
    ride.scans.push_back(std::move(scan));
  }
  return ride;
}

}  // namespace strata::experiments
