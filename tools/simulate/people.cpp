// SPDX-License-Identifier: Apache-2.0
#include "tools/simulate/people.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/random/stream.hpp"

namespace strata::simulate {
namespace {

using Eigen::Vector2d;
/// Streams of people begin here, those of doors and boxes at 0.
constexpr std::uint32_t kFirstPersonStream = 1U << 20;

Vector2d point_of(const std::vector<double>& path, std::size_t i) {
  return {path[2 * i], path[2 * i + 1]};
}

}  // namespace

People::People(const ScenarioConfig& scenario, std::uint64_t seed, int day)
    : personal_space_m_(scenario.robot.personal_space_m) {
  std::uint32_t index = kFirstPersonStream;
  for (const PersonConfig& person : scenario.people) {
    RandomStream random(seed, StreamId::kSimulatorWorld, static_cast<std::uint64_t>(day), index++);
    Walk walk{person, {0.0}, 0.0, 0.0};
    for (std::size_t i = 1; i < person.path.size() / 2; ++i) {
      walk.arc_m.push_back(walk.arc_m.back() +
                           (point_of(person.path, i) - point_of(person.path, i - 1)).norm());
    }
    walk.speed_mps = person.speed_mps * random.uniform(0.8, 1.2);
    const double one_way_s =
        walk.speed_mps > 0.0 ? walk.arc_m.back() / walk.speed_mps + person.pause_s : 0.0;
    walk.offset_s = random.uniform(0.0, 2.0 * one_way_s);
    walks_.push_back(std::move(walk));
  }
}

std::vector<Circle> People::legs_at(double time_s, const Vector2d& robot) const {
  std::vector<Circle> legs;
  legs.reserve(2 * walks_.size());
  for (const Walk& walk : walks_) {
    const std::vector<double>& path = walk.person.path;
    const double length_m = walk.arc_m.back();
    double walked_m = 0.0;  // along the path, there and back
    if (walk.speed_mps > 0.0) {
      const double one_way_s = length_m / walk.speed_mps;
      const double phase_s =
          std::fmod(time_s + walk.offset_s, 2.0 * (one_way_s + walk.person.pause_s));
      const double turned_s = one_way_s + walk.person.pause_s;
      walked_m = phase_s < turned_s
                     ? std::min(phase_s * walk.speed_mps, length_m)
                     : std::max(length_m - (phase_s - turned_s) * walk.speed_mps, 0.0);
    }
    std::size_t leg = 1;
    while (leg + 1 < walk.arc_m.size() && walk.arc_m[leg] < walked_m) ++leg;
    const Vector2d a = point_of(path, leg - 1);
    const Vector2d b = point_of(path, leg);
    const Vector2d ahead = (b - a) / std::max((b - a).norm(), 1e-9);
    const Vector2d left(-ahead.y(), ahead.x());
    Vector2d center = a + (walked_m - walk.arc_m[leg - 1]) * ahead;
    const Vector2d from_robot = center - robot;
    if (from_robot.norm() < personal_space_m_) {
      const Vector2d away = from_robot.norm() > 1e-6 ? from_robot.normalized() : left;
      center = robot + personal_space_m_ * away;
    }
    // One foot swings ahead while the other stands: opposite sines over a double step.
    const double swing_m =
        0.25 * walk.person.step_m * std::sin(std::numbers::pi * walked_m / walk.person.step_m);
    const Vector2d side = 0.5 * walk.person.leg_spread_m * left;
    legs.push_back({center + side + swing_m * ahead, walk.person.leg_radius_m});
    legs.push_back({center - side - swing_m * ahead, walk.person.leg_radius_m});
  }
  return legs;
}

}  // namespace strata::simulate
