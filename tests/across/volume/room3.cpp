// SPDX-License-Identifier: Apache-2.0
#include "tests/across/volume/room3.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

namespace strata::simulate {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

/// Where a ray enters and leaves a box, as multiples of `along`; nothing when it misses.
std::optional<std::pair<double, double>> cross(const Block& block, const Eigen::Vector3d& from,
                                               const Eigen::Vector3d& along) {
  double enter = -kFar;
  double leave = kFar;
  for (int i = 0; i < 3; ++i) {
    if (along[i] == 0.0) {
      if (from[i] < block.low[i] || from[i] > block.high[i]) return std::nullopt;
      continue;
    }
    double a = (block.low[i] - from[i]) / along[i];
    double b = (block.high[i] - from[i]) / along[i];
    if (a > b) std::swap(a, b);
    enter = std::max(enter, a);
    leave = std::min(leave, b);
  }
  if (enter > leave) return std::nullopt;
  return std::pair(enter, leave);
}

/// Range to an upright cylinder that stands on z = 0; infinite when missed.
double range_to_person(const Walker& walker, const Eigen::Vector2d& place,
                       const Eigen::Vector3d& from, const Eigen::Vector3d& along) {
  const Eigen::Vector2d offset = from.head<2>() - place;
  const Eigen::Vector2d d = along.head<2>();
  double best = kFar;
  const double a = d.squaredNorm();
  const double b = offset.dot(d);
  const double c = offset.squaredNorm() - walker.radius_m * walker.radius_m;
  if (a > 0.0 && b * b >= a * c) {
    const double t = (-b - std::sqrt(b * b - a * c)) / a;
    const double z = from.z() + t * along.z();
    if (t > 0.0 && z >= 0.0 && z <= walker.height_m) best = t;
  }
  if (along.z() < 0.0 && from.z() > walker.height_m) {  // the top of the head
    const double t = (walker.height_m - from.z()) / along.z();
    if ((offset + t * d).norm() <= walker.radius_m) best = std::min(best, t);
  }
  return best;
}

Block table(RandomStream& random, double side) {
  const Eigen::Vector3d size(random.uniform(0.6, 1.6), random.uniform(0.5, 0.9),
                             random.uniform(0.5, 2.0));
  const double x = random.uniform(-4.2, 4.2 - size.x());
  const double y =
      side > 0.0 ? random.uniform(1.8, 3.9 - size.y()) : random.uniform(-3.9, -1.8 - size.y());
  return {{x, y, 0.0}, {x + size.x(), y + size.y(), size.z()}};
}

}  // namespace

Eigen::Vector2d place_of(const Walker& walker, double time_s) {
  double length = 0.0;
  for (std::size_t i = 1; i < walker.path.size(); ++i) {
    length += (walker.path[i] - walker.path[i - 1]).norm();
  }
  const double walk_s = length / walker.speed_mps;
  const double period_s = 2.0 * (walk_s + walker.wait_s);
  double t = std::fmod(time_s + walker.start_s, period_s);
  if (t > walk_s + walker.wait_s) {
    t = std::max(0.0, walk_s - (t - walk_s - walker.wait_s));
  } else {
    t = std::min(t, walk_s);
  }
  double left = t * walker.speed_mps;
  for (std::size_t i = 1; i < walker.path.size(); ++i) {
    const Eigen::Vector2d step = walker.path[i] - walker.path[i - 1];
    if (left <= step.norm()) return walker.path[i - 1] + step.normalized() * left;
    left -= step.norm();
  }
  return walker.path.back();
}

Sweep3 sweep(const Room3& room, const Scanner3& scanner, const Pose3& map_from_sensor,
             double time_s, RandomStream& random) {
  Sweep3 result;
  std::vector<Eigen::Vector2d> places;
  for (const Walker& walker : room.people) places.push_back(place_of(walker, time_s));
  for (int layer = 0; layer < scanner.layers; ++layer) {
    const double share =
        scanner.layers > 1 ? static_cast<double>(layer) / (scanner.layers - 1) : 0.5;
    const double elevation =
        scanner.lowest_rad + (scanner.highest_rad - scanner.lowest_rad) * share;
    for (int beam = 0; beam < scanner.beams; ++beam) {
      const double azimuth = 2.0 * std::numbers::pi * beam / scanner.beams - std::numbers::pi;
      const Eigen::Vector3d in_sensor(std::cos(azimuth) * std::cos(elevation),
                                      std::sin(azimuth) * std::cos(elevation), std::sin(elevation));
      const Eigen::Vector3d along = map_from_sensor.rotation * in_sensor;
      const Eigen::Vector3d& from = map_from_sensor.translation;
      const auto inside = cross(room.walls, from, along);
      double range = inside ? inside->second : kFar;
      for (const Block& block : room.furniture) {
        const auto hit = cross(block, from, along);
        if (hit && hit->first > 0.0) range = std::min(range, hit->first);
      }
      bool on_person = false;
      for (std::size_t i = 0; i < places.size(); ++i) {
        const double person = range_to_person(room.people[i], places[i], from, along);
        on_person = on_person || person < range;
        range = std::min(range, person);
      }
      range += random.normal(0.0, scanner.noise_m);
      if (random.bernoulli(scanner.drop_rate) || range > scanner.max_range_m) {
        range = std::numeric_limits<double>::quiet_NaN();
      }
      result.points_m.push_back((in_sensor * range).cast<float>());
      result.on_person.push_back(on_person ? 1 : 0);
    }
  }
  return result;
}

Room3 random_room(std::uint64_t seed, int people) {
  RandomStream random(seed, StreamId::kSimulatorWorld);
  Room3 room;
  room.walls = {{-5.0 + random.uniform(-0.05, 0.05), -4.03, 0.0},
                {5.0 + random.uniform(-0.05, 0.05), 4.02, random.uniform(2.7, 3.1)}};
  for (int i = 0; i < 6; ++i) room.furniture.push_back(table(random, i % 2 == 0 ? 1.0 : -1.0));
  for (int i = 0; i < people; ++i) {
    Walker walker;
    const double lane = (i % 2 == 0 ? 1.0 : -1.0) * random.uniform(0.9, 1.4);
    walker.path = {{random.uniform(-4.4, -2.0), lane},
                   {random.uniform(-1.0, 1.0), lane * random.uniform(0.9, 1.1)},
                   {random.uniform(2.0, 4.4), lane}};
    walker.speed_mps = random.uniform(0.6, 1.3);
    walker.wait_s = random.uniform(0.0, 6.0);
    walker.start_s = random.uniform(0.0, 20.0);
    walker.radius_m = random.uniform(0.18, 0.26);
    walker.height_m = random.uniform(1.55, 1.9);
    room.people.push_back(walker);
  }
  return room;
}

}  // namespace strata::simulate
