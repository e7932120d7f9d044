// SPDX-License-Identifier: Apache-2.0
#include "memory/nodes/timescale_memory.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "tests/memory/nodes/room_world.hpp"

namespace strata::memory {
namespace {

using test_world::observe;

/// A robot that goes to and fro between x = -2.5 and 1.
TimescaleMemory after_a_walk(std::uint64_t seed, int scans = 400) {
  TimescaleMemory memory({}, seed);
  for (int t = 0; t < scans; ++t) {
    const double x = -0.75 + 1.75 * std::sin(0.02 * t);
    memory.observe(observe({x, 0.2, 0.01 * t}, 0.1 * t, t > scans / 2));
  }
  return memory;
}

TEST(TimescaleConfig, SaysWhatIsWrong) {
  TimescaleConfig config;
  EXPECT_TRUE(validate(config).empty());
  EXPECT_TRUE(validate(paper_timescale_config()).empty());
  config.levels.push_back({"short", 50, 2.0});
  const Problems problems = validate(config);
  ASSERT_EQ(problems.size(), 2U);
  EXPECT_THAT(problems[0].what, testing::HasSubstr("twice"));
  EXPECT_THAT(problems[1].what, testing::HasSubstr("forgets faster"));
  EXPECT_THROW(TimescaleMemory memory(config), ConfigError);
  config.levels.clear();
  EXPECT_THROW(TimescaleMemory memory(config), ConfigError);
}

TEST(TimescaleMemory, MakesNodesNoNearerThanTheirSpacing) {
  const TimescaleMemory memory = after_a_walk(1);
  ASSERT_GE(memory.nodes().size(), 2U);
  for (std::size_t a = 0; a < memory.nodes().size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      const double distance = (memory.nodes()[a].position_m - memory.nodes()[b].position_m).norm();
      EXPECT_GE(distance, memory.config().node_spacing_m);
    }
  }
}

TEST(TimescaleMemory, UpdatesTheNearestNodeOnlyWithinItsRadius) {
  TimescaleConfig config;
  config.node_spacing_m = 1.5;
  config.update_radius_m = 0.75;
  TimescaleMemory memory(config);
  EXPECT_TRUE(memory.observe(observe({0.0, 0.0, 0.0}, 0.0, false)).is_new_node);
  const Observed near = memory.observe(observe({0.7, 0.0, 0.0}, 1.0, false));
  EXPECT_EQ(near.outcome, ObserveOutcome::kTaken);
  EXPECT_EQ(near.node, 0);
  EXPECT_EQ(memory.observe(observe({1.0, 0.0, 0.0}, 2.0, false)).outcome, ObserveOutcome::kFarAway);
  EXPECT_EQ(memory.observe(observe({1.6, 0.0, 0.0}, 3.0, false)).node, 1);
  EXPECT_EQ(memory.nodes()[0].observations, 2U);
  EXPECT_EQ(memory.nodes()[1].observations, 1U);
  EXPECT_EQ(memory.observations(), 3U);
}

/// Only the beams within half of `field_rad` of straight ahead.
PosedScan with_field_of_view(PosedScan scan, double field_rad) {
  for (std::size_t i = 0; i < scan.scan.size(); ++i) {
    if (std::abs(scan.scan.bearing_rad(i)) > 0.5 * field_rad) scan.scan.ranges_m[i] = std::nanf("");
  }
  return scan;
}

TEST(TimescaleMemory, LearnsFromEveryPlaceAlongAWay) {
  // 180 degrees, there and back again: at every place some node must lie in what the scan saw.
  TimescaleMemory memory;
  for (int t = 0; t < 120; ++t) {
    const double x = t < 60 ? -3.0 + 0.1 * t : 3.0 - 0.1 * (t - 60);
    const double heading = t < 60 ? 0.0 : 3.14;
    const Observed observed =
        memory.observe(with_field_of_view(observe({x, 0.3, heading}, 2.0 * t, false), 3.1416));
    EXPECT_EQ(observed.outcome, ObserveOutcome::kTaken) << "at x = " << x;
  }
  EXPECT_LE(memory.nodes().size(), 7U);  // 6 m of way
}

TEST(TimescaleMemory, TakesTheNextNodeWhenAWallHidesTheNearest) {
  // A wall at x = 0.4 stands between the node at the origin and a laser at x = 0.8.
  TimescaleMemory memory;
  EXPECT_EQ(memory.observe(observe({0.0, 0.0, 0.0}, 0.0, false)).node, 0);
  auto behind_wall = [](const Pose2& pose, double time_s) {
    PosedScan scan = observe(pose, time_s, false);
    for (std::size_t i = 0; i < scan.scan.size(); ++i) {
      const double c = std::cos(scan.scan.bearing_rad(i));
      if (c >= -1e-3) continue;
      scan.scan.ranges_m[i] = std::min(scan.scan.ranges_m[i], static_cast<float>(-0.4 / c));
    }
    return scan;
  };
  const Observed first = memory.observe(behind_wall({0.8, 0.0, 0.0}, 10.0));
  EXPECT_EQ(first.outcome, ObserveOutcome::kTaken);
  EXPECT_TRUE(first.is_new_node);
  EXPECT_EQ(memory.observe(behind_wall({0.8, 0.1, 0.0}, 20.0)).node, 1);
  EXPECT_EQ(memory.nodes()[0].observations, 1U);
}

TEST(TimescaleMemory, TakesAsManyScansFromAFastScannerAsFromASlowOne) {
  std::vector<std::uint64_t> taken;
  for (const int rate_hz : {2, 10, 40}) {
    TimescaleMemory memory;
    for (int i = 0; i < 30 * rate_hz; ++i) {
      memory.observe(observe({0.0, 0.0, 0.0}, static_cast<double>(i) / rate_hz, false));
    }
    taken.push_back(memory.observations());
  }
  EXPECT_THAT(taken, testing::Each(30U));
}

TEST(TimescaleMemory, TakesAScanSoonerWhenTheRobotMovedOrANewRunBegan) {
  TimescaleMemory memory;
  memory.observe(observe({0.0, 0.0, 0.0}, 0.0, false));
  auto outcome = [&](const Pose2& pose, int run) {
    PosedScan scan = observe(pose, 0.1, false);
    scan.run = run;
    return memory.observe(scan).outcome;
  };
  EXPECT_EQ(outcome({0.1, 0.0, 0.0}, 0), ObserveOutcome::kTooSoon);
  EXPECT_EQ(outcome({0.2, 0.0, 0.0}, 0), ObserveOutcome::kTaken);
  EXPECT_EQ(outcome({0.2, 0.0, 0.2}, 0), ObserveOutcome::kTaken);
  EXPECT_EQ(outcome({0.2, 0.0, 0.2}, 0), ObserveOutcome::kTooSoon);
  EXPECT_EQ(outcome({0.2, 0.0, 0.2}, 1), ObserveOutcome::kTaken);
}

TEST(TimescaleMemory, ForgetsAsFastWithTwoRobotsAtANodeAsWithOne) {
  TimescaleMemory memory({}, 1);
  for (int t = 0; t < 200; ++t) {  // 10 Hz, standing 0.6 m apart
    memory.observe(observe({0.0, 0.0, 0.0}, 0.1 * t, false), nullptr, 0);
    memory.observe(observe({0.6, 0.0, 0.0}, 0.1 * t + 0.05, false), nullptr, 1);
  }
  ASSERT_EQ(memory.nodes().size(), 1U);
  EXPECT_NEAR(static_cast<double>(memory.nodes()[0].observations), 20.0, 1.0);
}

TEST(TimescaleMemory, RemembersNothingFromAnUncertainPose) {
  TimescaleMemory memory;
  Eigen::Matrix3d covariance = Eigen::Vector3d(0.2 * 0.2, 1e-4, 1e-4).asDiagonal();
  const PosedScan scan = observe({0.0, 0.0, 0.0}, 0.0, false);
  EXPECT_EQ(memory.observe(scan, &covariance).outcome, ObserveOutcome::kUncertain);
  EXPECT_TRUE(memory.nodes().empty());
  covariance(0, 0) = 0.05 * 0.05;
  EXPECT_EQ(memory.observe(scan, &covariance).outcome, ObserveOutcome::kTaken);
  PosedScan lost = scan;
  lost.map_from_robot.x = std::nan("");
  EXPECT_EQ(memory.observe(lost).outcome, ObserveOutcome::kUncertain);
}

TEST(TimescaleMemory, WarmsUpToAnEvenSampleOfAllObservations) {
  TimescaleMemory memory;
  auto share_of_box = [&] {
    const NodeLevel& level = memory.nodes()[0].levels[2];
    double with = 0.0;
    double all = 0.0;
    for (int a = 0; a < 10; ++a) {  // the box covers these bins
      for (const float range : level.samples(a)) with += range < 3.0F ? 1.0 : 0.0;
      all += static_cast<double>(level.samples(a).size());
    }
    return with / all;
  };
  for (int t = 0; t < 30; ++t) memory.observe(observe({0.0, 0.0, 0.0}, t, false));
  EXPECT_EQ(memory.nodes()[0].levels[2].insertions(), 30U);
  for (int t = 30; t < 400; ++t) memory.observe(observe({0.0, 0.0, 0.0}, t, t >= 300));
  EXPECT_NEAR(share_of_box(), 0.25, 0.1);
}

TEST(TimescaleMemory, FillsItsLevelsAtTheirOwnRatesWithoutWarmingUp) {
  TimescaleConfig config;
  config.warm_up = false;
  TimescaleMemory memory(config);
  for (int t = 0; t < 2000; ++t) memory.observe(observe({0.0, 0.0, 0.0}, t, false));
  ASSERT_EQ(memory.nodes().size(), 1U);
  const auto& levels = memory.nodes()[0].levels;
  EXPECT_NEAR(static_cast<double>(levels[0].insertions()), 2000.0, 1.0);
  EXPECT_NEAR(static_cast<double>(levels[1].insertions()),
              2000.0 * 20 * -std::expm1(-std::log(2.0) / 27.0), 90.0);
  EXPECT_NEAR(static_cast<double>(levels[2].insertions()), 100.0, 40.0);
}

TEST(TimescaleMemory, IsByteIdenticalAfterReplayWithTheSameSeed) {
  EXPECT_EQ(after_a_walk(5).state(), after_a_walk(5).state());
  EXPECT_NE(after_a_walk(5).state(), after_a_walk(6).state());
}

TEST(TimescaleMemory, StatesItsSize) {
  const TimescaleMemory memory = after_a_walk(5);
  EXPECT_EQ(memory.bytes(), memory.state().size());
}

TimescaleMemory restored(const TimescaleMemory& memory) {
  std::vector<TimescaleMemory::NodeState> nodes;
  for (std::size_t n = 0; n < memory.nodes().size(); ++n) nodes.push_back(memory.node_state(n));
  return TimescaleMemory::restore(memory.head_state(), nodes, "test");
}

TEST(TimescaleMemory, GoesOnAfterRestoringAsIfNothingHadHappened) {
  TimescaleMemory original = after_a_walk(7);
  TimescaleMemory copy = restored(original);
  EXPECT_EQ(copy.state(), original.state());
  for (int t = 0; t < 50; ++t) {
    const PosedScan scan = observe({0.3, 0.1, 0.2 * t}, 100.0 + 0.4 * t, true);
    original.observe(scan);
    copy.observe(scan);
  }
  EXPECT_EQ(copy.state(), original.state());
}

TEST(TimescaleMemory, KeepsItsConfigurationInItsState) {
  TimescaleConfig config = paper_timescale_config();
  config.levels = {{"daily, 50%", 7, 123.456789012345}};
  config.visibility.trust_no_return = false;
  const TimescaleMemory copy = restored(TimescaleMemory(config, 3));
  EXPECT_EQ(copy.config().range_bins, 20);
  EXPECT_TRUE(copy.config().coupled_eviction);
  EXPECT_FALSE(copy.config().visibility.trust_no_return);
  ASSERT_EQ(copy.config().levels.size(), 1U);
  EXPECT_EQ(copy.config().levels[0].name, "daily, 50%");
  EXPECT_EQ(copy.config().levels[0].half_life_s, 123.456789012345);
}

TEST(TimescaleMemory, RefusesAStateThatIsDamaged) {
  const TimescaleMemory memory = after_a_walk(1, 40);
  std::vector<TimescaleMemory::NodeState> nodes{memory.node_state(0)};
  const std::vector<std::byte> head = memory.head_state();
  const std::span<const std::byte> cut(head.data(), head.size() / 2);
  EXPECT_THROW((void)TimescaleMemory::restore(cut, nodes, "test"), InputError);
  nodes[0].levels[1].pop_back();
  EXPECT_THROW((void)TimescaleMemory::restore(head, nodes, "test"), InputError);
  nodes.clear();
  EXPECT_THROW((void)TimescaleMemory::restore(head, nodes, "test"), InputError);
}

}  // namespace
}  // namespace strata::memory
