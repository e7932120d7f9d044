// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/corridor_building.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include <Eigen/Core>

#include "core/base/error.hpp"
#include "core/random/stream.hpp"

namespace strata::experiments {
namespace {

constexpr std::uint64_t kPlans = 5151;  // of the stream of worlds
constexpr double kReach_m = 8.0;        // of the scanner: about to the next crossing

Eigen::Vector2d middle_of(const CorridorPlan& plan, std::size_t crossing) {
  const auto columns = static_cast<std::size_t>(plan.columns);
  const std::size_t row = crossing / columns;
  return {plan.spacing_x_m * static_cast<double>(crossing % columns),
          plan.spacing_y_m * static_cast<double>(row)};
}

void add_rectangle(const Eigen::Vector2d& low, const Eigen::Vector2d& high,
                   simulate::ScenarioConfig& building) {
  building.walls.push_back({{low.x(), low.y(), high.x(), low.y(), high.x(), high.y(), low.x(),
                             high.y(), low.x(), low.y()}});
}

/// The outer wall, and the blocks between the corridors.
void add_blocks(const CorridorPlan& plan, simulate::ScenarioConfig& building) {
  const Eigen::Vector2d half = Eigen::Vector2d::Constant(0.5 * plan.width_m);
  add_rectangle(-half, middle_of(plan, plan.crossings() - 1) + half, building);
  for (int row = 0; row + 1 < plan.rows; ++row) {
    for (int column = 0; column + 1 < plan.columns; ++column) {
      const Eigen::Vector2d low(plan.spacing_x_m * column, plan.spacing_y_m * row);
      const Eigen::Vector2d high = low + Eigen::Vector2d(plan.spacing_x_m, plan.spacing_y_m);
      add_rectangle(low + half, high - half, building);
    }
  }
}

/// Walls across both ends of a corridor, in line with those of the crossings.
void close(const CorridorPlan& plan, std::size_t a, std::size_t b,
           simulate::ScenarioConfig& building) {
  const double half_m = 0.5 * plan.width_m;
  const Eigen::Vector2d along = (middle_of(plan, b) - middle_of(plan, a)).normalized();
  const Eigen::Vector2d across(-along.y(), along.x());
  for (const Eigen::Vector2d& end : {Eigen::Vector2d(middle_of(plan, a) + half_m * along),
                                     Eigen::Vector2d(middle_of(plan, b) - half_m * along)}) {
    const Eigen::Vector2d one = end - half_m * across;
    const Eigen::Vector2d other = end + half_m * across;
    building.walls.push_back({{one.x(), one.y(), other.x(), other.y()}});
  }
}

bool is_connected(const CorridorPlan& plan) {
  std::vector<std::size_t> found{0};
  for (std::size_t i = 0; i < found.size(); ++i) {
    for (const std::size_t next : plan.beside(found[i])) {
      if (std::find(found.begin(), found.end(), next) == found.end()) found.push_back(next);
    }
  }
  return found.size() == plan.crossings();
}

/// One corridor of seven is closed, where all crossings stay within reach.
void close_some(RandomStream& random, CorridorPlan& plan) {
  for (std::size_t a = 0; a < plan.crossings(); ++a) {
    for (const std::size_t b : plan.beside(a)) {
      if (b < a || !random.bernoulli(1.0 / 7.0)) continue;
      plan.closed.emplace_back(a, b);
      if (!is_connected(plan)) plan.closed.pop_back();
    }
  }
}

}  // namespace

bool CorridorPlan::is_open(std::size_t a, std::size_t b) const {
  const auto [low, high] = std::minmax(a, b);
  const auto width = static_cast<std::size_t>(columns);
  if (high >= crossings()) return false;
  const bool is_beside = high == low + width || (high == low + 1 && high % width != 0);
  return is_beside && std::find(closed.begin(), closed.end(), std::pair(low, high)) == closed.end();
}

std::vector<std::size_t> CorridorPlan::beside(std::size_t crossing) const {
  std::vector<std::size_t> result;
  for (std::size_t other = 0; other < crossings(); ++other) {
    if (is_open(crossing, other)) result.push_back(other);
  }
  return result;
}

void set_odometry_error(simulate::RobotConfig& robot, double share) {
  robot.scale_stddev = robot.trans_noise = share;
  robot.turn_scale_stddev = robot.rot_noise = 0.2 * share;
}

simulate::ScenarioConfig corridor_building(const CorridorPlan& plan) {
  simulate::ScenarioConfig building;
  building.name = "corridors";
  add_blocks(plan, building);
  for (const auto& [a, b] : plan.closed) close(plan, a, b, building);
  for (std::size_t i = 0; i < plan.route.size(); ++i) {
    if (i > 0 && !plan.is_open(plan.route[i - 1], plan.route[i])) {
      throw ConfigError("route", "leads where no corridor is", "name crossings beside each other");
    }
    const Eigen::Vector2d at = middle_of(plan, plan.route[i]);
    building.robot.route.insert(building.robot.route.end(), {at.x(), at.y()});
  }
  building.robot.speed_mps = 0.75;
  building.laser.range_max_m = kReach_m;
  return building;
}

CorridorPlan random_corridors(std::uint64_t seed) {
  RandomStream random(seed, StreamId::kSimulatorWorld, kPlans);
  CorridorPlan plan;
  plan.columns = 3 + static_cast<int>(random.below(3));
  plan.rows = 3;
  plan.spacing_x_m = random.uniform(6.5, 9.0);
  plan.spacing_y_m = random.uniform(6.5, 9.0);
  plan.width_m = random.uniform(1.8, 2.2);
  close_some(random, plan);
  const auto visits = 14 + random.below(7);
  plan.route = {random.below(static_cast<std::uint32_t>(plan.crossings()))};
  std::optional<std::size_t> before;
  while (plan.route.size() < visits) {
    std::vector<std::size_t> ways = plan.beside(plan.route.back());
    if (before && ways.size() > 1) std::erase(ways, *before);
    before = plan.route.back();
    plan.route.push_back(ways[random.below(static_cast<std::uint32_t>(ways.size()))]);
  }
  return plan;
}

}  // namespace strata::experiments
