// SPDX-License-Identifier: Apache-2.0
#include "core/cells/cell_beliefs.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/core/cells/corridor.hpp"

namespace strata::cells {
namespace {

using namespace test_corridor;

constexpr double kRate_per_s = 1.0 / 600.0;

/// The corridor with a door that is closed a fifth of the time.
CellMap map_of_beliefs() {
  CellLearner learner(kResolution_m);
  visit(learner, 0.0, false);
  CellMap map = learned(learner);
  CellState& door = map.cells.at(cell_at(kDoor, kResolution_m));
  door.usual = 0.2F;
  door.rate_per_s = static_cast<float>(kRate_per_s);
  door.log_odds = static_cast<float>(log_odds_of(0.1));
  door.stamp = Stamp::from_seconds(0.0);
  return map;
}

float shown(const CellBeliefs& beliefs, const Eigen::Vector2d& point_m) {
  return beliefs.grid().get(beliefs.grid().cell_at(point_m));
}

/// Sees the door closed until it is believed.
void close_door(double time_s, CellBeliefs& beliefs) {
  for (int i = 0; i < 8; ++i) beliefs.observe(look(time_s + 0.1 * i, true).scan, kPose);
}

// P = [free to occupied, ...] by hand: 0.2 + e^-1 (0.1 - 0.2), twice.
TEST(CellBeliefs, FadeAsTheTwoStateChainByHand) {
  const CellBeliefs beliefs(map_of_beliefs());
  const double once = 0.2 - 0.1 * std::exp(-1.0);
  EXPECT_NEAR(*beliefs.occupied(kDoor, Stamp::from_seconds(600.0)), once, 1e-6);
  const double twice = 0.2 - 0.1 * std::exp(-2.0);
  EXPECT_NEAR(*beliefs.occupied(kDoor, Stamp::from_seconds(1200.0)), twice, 1e-6);
  EXPECT_NEAR(*beliefs.occupied(kDoor, Stamp::from_seconds(1e7)), 0.2, 1e-6);
  // One step of the chain's matrix, [1 - a, a; b, 1 - b], a = usual (1 - kept), b = the other.
  const double kept = std::exp(-1.0);
  const double a = 0.2 * (1.0 - kept);
  const double b = 0.8 * (1.0 - kept);
  EXPECT_NEAR(0.9 * a + 0.1 * (1.0 - b), once, 1e-12);
}

// Two looks by hand: Bayes, fade, Bayes.
TEST(CellBeliefs, TakeInScansAsBayesSays) {
  CellConfig config;
  config.max_scan_nats = 100.0;
  CellBeliefs beliefs(map_of_beliefs(), config);
  beliefs.observe(look(300.0, true).scan, kPose);
  const double kept = std::exp(-0.5);
  const double before = 0.2 + kept * (0.1 - 0.2);
  const double hit = before * 0.6 / (before * 0.6 + (1.0 - before) * 0.05);
  EXPECT_NEAR(*beliefs.occupied(kDoor, Stamp::from_seconds(300.0)), hit, 1e-5);
  beliefs.observe(look(600.0, false).scan, kPose);
  const double faded_hit = 0.2 + kept * (hit - 0.2);
  const double miss = faded_hit * 0.4 / (faded_hit * 0.4 + (1.0 - faded_hit) * 0.95);
  EXPECT_NEAR(*beliefs.occupied(kDoor, Stamp::from_seconds(600.0)), miss, 1e-5);
}

TEST(CellBeliefs, OneScanSaysOnlySoMuch) {
  CellConfig config;
  config.max_scan_nats = 0.5;
  CellBeliefs beliefs(map_of_beliefs(), config);
  beliefs.observe(look(0.0, true).scan, kPose);
  EXPECT_NEAR(log_odds_of(*beliefs.occupied(kDoor, Stamp{})), log_odds_of(0.1) + 0.5, 1e-5);
}

TEST(CellBeliefs, ShowADoorThatClosesAndForgetItByTheChain) {
  CellConfig config;
  CellBeliefs beliefs(map_of_beliefs(), config);
  EXPECT_EQ(shown(beliefs, kDoor), 0.0F);
  EXPECT_EQ(shown(beliefs, kWall), 1.0F);
  close_door(1.0, beliefs);
  EXPECT_TRUE(beliefs.refresh(Stamp::from_seconds(100.0)));
  EXPECT_EQ(shown(beliefs, kDoor), 1.0F);
  // 0.2 + e^-x 0.79 is 0.5 at x = ln(0.79 / 0.3): after 580 s.
  EXPECT_FALSE(beliefs.refresh(Stamp::from_seconds(500.0)));
  EXPECT_EQ(shown(beliefs, kDoor), 1.0F);
  EXPECT_TRUE(beliefs.refresh(Stamp::from_seconds(700.0)));
  EXPECT_EQ(shown(beliefs, kDoor), 0.0F);
  EXPECT_EQ(shown(beliefs, kWall), 1.0F);
}

TEST(CellBeliefs, ShowWhatChangedOnlySoOften) {
  CellConfig config;
  config.refresh_s = 20.0;
  CellBeliefs beliefs(map_of_beliefs(), config);
  EXPECT_FALSE(beliefs.refresh(Stamp::from_seconds(1.0)));
  close_door(1.0, beliefs);
  EXPECT_FALSE(beliefs.refresh(Stamp::from_seconds(20.0)));
  EXPECT_EQ(shown(beliefs, kDoor), 0.0F);
  EXPECT_TRUE(beliefs.refresh(Stamp::from_seconds(21.5)));
  // A clock that was set back does not stop it.
  for (int i = 0; i < 30; ++i) beliefs.observe(look(-100.0 + i, false).scan, kPose);
  EXPECT_TRUE(beliefs.refresh(Stamp::from_seconds(-70.0)));
  EXPECT_EQ(shown(beliefs, kDoor), 0.0F);
}

TEST(CellBeliefs, WhatTheMapDoesNotKnowStaysUnknown) {
  CellBeliefs beliefs(map_of_beliefs());
  for (int i = 0; i < 20; ++i) {
    beliefs.observe(look(i, true).scan, {0.02, 0.02, 0.5});  // into unknown cells
    beliefs.observe(look(i, true).scan, {50.0, 50.0, 0.0});  // far outside
  }
  EXPECT_FALSE(beliefs.refresh(Stamp::from_seconds(100.0)));
  EXPECT_FALSE(beliefs.occupied({1.5, 0.9}, Stamp{}).has_value());
  EXPECT_FALSE(beliefs.occupied({52.0, 50.0}, Stamp{}).has_value());
}

}  // namespace
}  // namespace strata::cells
