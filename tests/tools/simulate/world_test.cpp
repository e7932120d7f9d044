// SPDX-License-Identifier: Apache-2.0
#include "tools/simulate/world.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/random/stream.hpp"

namespace strata::simulate {
namespace {

using Eigen::Vector2d;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(RayToSegment, MeetsClosedForms) {
  const Segment wall{{2, -1}, {2, 1}};
  EXPECT_DOUBLE_EQ(ray_to_segment({0, 0}, {1, 0}, wall), 2.0);
  EXPECT_DOUBLE_EQ(ray_to_segment({0, 1}, {1, 0}, wall), 2.0) << "an end belongs to the wall";
  EXPECT_EQ(ray_to_segment({0, 1.001}, {1, 0}, wall), kInfinity);
  EXPECT_EQ(ray_to_segment({0, 0}, {-1, 0}, wall), kInfinity) << "behind";
  const double r = std::sqrt(0.5);
  EXPECT_NEAR(ray_to_segment({1, 0}, {r, r}, wall), std::sqrt(2.0), 1e-12);
}

TEST(RayToSegment, AlongTheSegmentEndsAtItsNearerEnd) {
  EXPECT_DOUBLE_EQ(ray_to_segment({0, 0}, {1, 0}, {{5, 0}, {3, 0}}), 3.0);
  EXPECT_DOUBLE_EQ(ray_to_segment({4, 0}, {1, 0}, {{5, 0}, {3, 0}}), 0.0);
  EXPECT_EQ(ray_to_segment({6, 0}, {1, 0}, {{5, 0}, {3, 0}}), kInfinity);
  EXPECT_EQ(ray_to_segment({0, 1}, {1, 0}, {{5, 0}, {3, 0}}), kInfinity);
}

TEST(RayToSegment, EndsOnTheSegmentForRandomRays) {
  RandomStream random(3, StreamId::kTest);
  for (int i = 0; i < 20000; ++i) {
    const Segment s{{random.normal(), random.normal()}, {random.normal(), random.normal()}};
    const Vector2d from(random.normal(), random.normal());
    const double angle = random.uniform(0.0, 2.0 * std::numbers::pi);
    const Vector2d direction(std::cos(angle), std::sin(angle));
    const double range = ray_to_segment(from, direction, s);
    if (std::isinf(range)) continue;
    ASSERT_LT(distance_to_segment(from + range * direction, s), 1e-6);
    ASSERT_GE(range, 0.0);
  }
  // Towards any point of a segment there is no missing it.
  for (int i = 0; i < 20000; ++i) {
    const Segment s{{random.normal(), random.normal()}, {random.normal(), random.normal()}};
    const Vector2d from(random.normal(), random.normal());
    const Vector2d target = s.a + random.uniform(0.01, 0.99) * (s.b - s.a);
    const double range = ray_to_segment(from, (target - from).normalized(), s);
    ASSERT_NEAR(range, (target - from).norm(), 1e-6);
  }
}

TEST(RayToCircle, MeetsClosedForms) {
  const Circle leg{{3, 0}, 0.5};
  EXPECT_DOUBLE_EQ(ray_to_circle({0, 0}, {1, 0}, leg), 2.5);
  EXPECT_EQ(ray_to_circle({0, 0}, {-1, 0}, leg), kInfinity);
  EXPECT_EQ(ray_to_circle({0, 0.6}, {1, 0}, leg), kInfinity);
  EXPECT_NEAR(ray_to_circle({0, 0.5}, {1, 0}, leg), 3.0, 1e-7) << "touching";
  EXPECT_EQ(ray_to_circle({3, 0.2}, {1, 0}, leg), 0.0) << "from inside";
}

ScenarioConfig walled() {
  ScenarioConfig scenario;
  scenario.walls.push_back({{0, 0, 10, 0}});
  scenario.robot.route = {1, 1, 2, 1};
  return scenario;
}

DoorConfig door_in_wall(DoorKind kind) {
  DoorConfig door;
  door.id = "d";
  door.kind = kind;
  door.at = {4, 0, 5, 0};
  door.open_deg = 90;
  return door;
}

TEST(World, DoorsCutTheirGapIntoTheWall) {
  ScenarioConfig scenario = walled();
  scenario.doors = {door_in_wall(DoorKind::kHinged)};
  const World world(scenario, 1, 10.0);
  ASSERT_EQ(world.walls().size(), 2U);
  EXPECT_EQ(world.walls()[0].b, Vector2d(4, 0));
  EXPECT_EQ(world.walls()[1].a, Vector2d(5, 0));
}

TEST(World, DoorLeavesTurnOrSlide) {
  ScenarioConfig scenario = walled();
  scenario.doors = {door_in_wall(DoorKind::kHinged)};
  const World hinged(scenario, 1, 10.0);
  const auto& shapes = hinged.objects()[0].shapes;
  ASSERT_EQ(shapes.size(), 3U);
  EXPECT_LT((shapes[0][0].b - Vector2d(5, 0)).norm(), 1e-12);
  EXPECT_LT((shapes[2][0].b - Vector2d(4, 1)).norm(), 1e-12);
  EXPECT_NEAR((shapes[1][0].b - shapes[1][0].a).norm(), 1.0, 1e-12) << "the leaf keeps its length";
  scenario.doors = {door_in_wall(DoorKind::kSliding)};
  const World sliding(scenario, 1, 10.0);
  EXPECT_TRUE(sliding.objects()[0].shapes[2].empty());
  EXPECT_NEAR(sliding.objects()[0].shapes[1][0].b.x(), 4.6, 1e-12) << "ajar: 40% gone";
}

TEST(World, ScheduledStatesHoldUntilTheNextEntry) {
  ScenarioConfig scenario = walled();
  scenario.days = 3;
  DoorConfig door = door_in_wall(DoorKind::kHinged);
  door.states.schedule = {{2, 5.0, "open"}, {1, 2.0, "ajar"}};
  scenario.doors = {door};
  const World world(scenario, 1, 10.0);
  const ChangeableObject& object = world.objects()[0];
  EXPECT_EQ(object.state_at(1, 0.0), 1U) << "the first entry's state also before it";
  EXPECT_EQ(object.state_at(2, 4.9), 1U);
  EXPECT_EQ(object.state_at(2, 5.0), 2U);
  EXPECT_EQ(object.state_at(3, 0.0), 2U);
}

TEST(World, DrawnStatesFollowTheirProbabilities) {
  ScenarioConfig scenario = walled();
  scenario.days = 4000;
  DoorConfig door = door_in_wall(DoorKind::kHinged);
  door.states.probabilities = {0.2, 0.0, 0.8};
  scenario.doors = {door};
  const World world(scenario, 5, 10.0);
  int open = 0;
  for (const StateChange& change : world.objects()[0].history) {
    EXPECT_NE(change.state, 1U);
    open += change.state == 2 ? 1 : 0;
  }
  EXPECT_NEAR(open / 4000.0, 0.8, 4.0 * std::sqrt(0.16 / 4000.0));
}

TEST(World, RedrawsStatesDuringTheDay) {
  ScenarioConfig scenario = walled();
  DoorConfig door = door_in_wall(DoorKind::kHinged);
  door.states.redraw_every_s = 2.0;
  scenario.doors = {door};
  EXPECT_EQ(World(scenario, 5, 10.0).objects()[0].history.size(), 5U);
}

TEST(World, RefusesUnknownStatesAndDoubleIds) {
  ScenarioConfig scenario = walled();
  DoorConfig door = door_in_wall(DoorKind::kHinged);
  scenario.doors = {door, door};
  EXPECT_THROW(World(scenario, 1, 10.0), ConfigError);
  door.states.schedule = {{1, 0.0, "wide"}};
  scenario.doors = {door};
  EXPECT_THROW(World(scenario, 1, 10.0), ConfigError);
  door.states = {};
  door.states.probabilities = {1.0};
  scenario.doors = {door};
  EXPECT_THROW(World(scenario, 1, 10.0), ConfigError);
}

}  // namespace
}  // namespace strata::simulate
