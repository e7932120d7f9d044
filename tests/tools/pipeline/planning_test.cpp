// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/planning.hpp"

#include <functional>
#include <optional>
#include <queue>

#include <gtest/gtest.h>

#include "core/random/stream.hpp"
#include "tools/pipeline/path_planner.hpp"

namespace strata::pipeline {
namespace {

/// A known hall of cells of 0.1 m; `is_wall` says which are occupied.
ReflectionGrid hall(int width, int height, const std::function<bool(Cell)>& is_wall) {
  ReflectionGrid map = make_reflection_grid(0.1, {{0, 0}, {width, height}});
  for (std::size_t i = 0; i < map.size(); ++i) map.values()[i] = is_wall(map.cell(i)) ? 1.0F : 0.0F;
  return map;
}

TEST(PathPlanner, GoesThroughADoorAndAroundWhenItIsClosed) {
  // A wall at x = 2 m with a door at y in [1, 2) and a passage at its far end.
  const auto is_wall = [](bool closed) {
    return [closed](Cell cell) {
      const bool in_door = cell.y >= 10 && cell.y < 20;
      return cell.x == 20 && cell.y < 70 && (closed || !in_door);
    };
  };
  const Eigen::Vector2d start{1.05, 1.55};
  const Eigen::Vector2d goal{3.05, 1.55};
  const auto open = PathPlanner(hall(40, 80, is_wall(false)), 0.25).plan(start, goal);
  const auto closed = PathPlanner(hall(40, 80, is_wall(true)), 0.25).plan(start, goal);
  ASSERT_TRUE(open && closed);
  EXPECT_NEAR(length_m(*open), 2.0, 1e-9);
  EXPECT_GT(length_m(*closed), 10.0);
  EXPECT_GT(frechet_m(*open, *closed), 5.0);
}

TEST(PathPlanner, FindsNoWayThroughAGapNarrowerThanTheRobot) {
  const auto is_wall = [](Cell cell) { return cell.x == 20 && cell.y != 15 && cell.y != 16; };
  const ReflectionGrid map = hall(40, 40, is_wall);
  EXPECT_FALSE(PathPlanner(map, 0.25).plan({1.0, 1.5}, {3.0, 1.5}).has_value());
  EXPECT_TRUE(PathPlanner(map, 0.05).plan({1.0, 1.5}, {3.0, 1.5}).has_value());
}

/// Shortest length by relaxing every cell until nothing changes.
std::optional<double> slow_length_m(const ReflectionGrid& map, Cell start, Cell goal) {
  Grid<double> cost(map.resolution_m(), map.rect(), 1e18);
  cost.at(start) = 0.0;
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t i = 0; i < map.size(); ++i) {
      const Cell cell = map.cell(i);
      if (map.at(cell) > 0.0F) continue;
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          const Cell next{cell.x + dx, cell.y + dy};
          if (!map.contains(next) || map.at(next) > 0.0F) continue;
          const double sum = cost.at(next) + (dx != 0 && dy != 0 ? std::sqrt(2.0) : 1.0) * 0.1;
          if (next == cell || sum >= cost.at(cell) - 1e-12) continue;
          cost.at(cell) = sum;
          changed = true;
        }
      }
    }
  }
  if (cost.at(goal) > 1e17) return std::nullopt;
  return cost.at(goal);
}

TEST(PathPlanner, IsAsShortAsASlowSearchInRandomMazes) {
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    RandomStream random(seed, StreamId::kTest);
    const ReflectionGrid map = hall(20, 20, [&](Cell cell) {
      return random.uniform() < 0.4 && cell != Cell{0, 0} && cell != Cell{19, 19};
    });
    const auto path = PathPlanner(map, 0.01).plan({0.05, 0.05}, {1.95, 1.95});
    const auto expected = slow_length_m(map, {0, 0}, {19, 19});
    ASSERT_EQ(path.has_value(), expected.has_value()) << seed;
    if (!path) continue;
    ++found;
    EXPECT_NEAR(length_m(*path), *expected, 1e-6) << seed;
  }
  EXPECT_GT(found, 3);
}

TEST(Frechet, OfShiftedLinesIsTheShift) {
  Path a;
  Path b;
  for (int i = 0; i < 30; ++i) {
    a.emplace_back(0.1 * i, 0.0);
    b.emplace_back(0.1 * i, 0.7);
  }
  EXPECT_NEAR(frechet_m(a, b), 0.7, 1e-12);
  EXPECT_EQ(frechet_m(a, a), 0.0);
}

/// Knows one map until a scan is learned, and another from there on.
class Changeable final : public OnlinePredictor {
 public:
  Changeable(ReflectionGrid before, ReflectionGrid after, int change_after)
      : maps_{std::make_shared<const ReflectionGrid>(std::move(before)),
              std::make_shared<const ReflectionGrid>(std::move(after))},
        left_(change_after) {}
  void go_to(const Pose2& /*robot*/, Stamp /*stamp*/) override {}
  maps::RangeFunction expected_range() override { return {}; }
  void learn(const Observation& /*seen*/, const Pose2& /*robot*/) override { --left_; }
  std::shared_ptr<const ReflectionGrid> map() override { return maps_[left_ > 0 ? 0 : 1]; }

 private:
  std::array<std::shared_ptr<const ReflectionGrid>, 2> maps_;
  int left_;
};

TEST(JudgePlanning, CountsWaysThroughWhatTheDriveFoundAndHowTheyChange) {
  const auto door = [](bool closed) {
    return hall(40, 80, [closed](Cell cell) {
      const bool in_door = cell.y >= 10 && cell.y < 20;
      return cell.x == 20 && cell.y < 70 && (closed || !in_door);
    });
  };
  std::vector<Observation> observations(30);
  std::vector<std::optional<Pose2>> truths;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    observations[i].scan.stamp = Stamp::from_seconds(static_cast<double>(i));
    truths.emplace_back(Pose2{1.05 + 2.0 * static_cast<double>(i) / 29.0, 1.55, 0.0});
  }
  const TestScans test{observations, truths, nullptr};
  const std::vector<PlanningTask> tasks{{{1.05, 1.55}, {3.05, 1.55}}};
  Changeable learns(door(false), door(true), 15);
  Changeable stays(door(false), door(false), 15);
  const PlanningScore adapted = judge_planning(test, tasks, door(true), learns, 10);
  const PlanningScore stubborn = judge_planning(test, tasks, door(true), stays, 10);
  EXPECT_EQ(stubborn.queries, 10U);
  EXPECT_EQ(stubborn.blocked, 10U);
  EXPECT_NEAR(*stubborn.length_cv, 0.0, 1e-12);
  EXPECT_EQ(*stubborn.frechet_m, 0.0);
  EXPECT_EQ(adapted.blocked, 5U);
  EXPECT_GT(*adapted.length_cv, 0.3);
  EXPECT_GT(*adapted.frechet_m, 0.5);
}

}  // namespace
}  // namespace strata::pipeline
