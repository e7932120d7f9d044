// SPDX-License-Identifier: Apache-2.0
#include "core/localization/recovery.hpp"

#include <gtest/gtest.h>

namespace strata::localization {
namespace {

/// A monitor that has seen a good pose for a while, and then `inlier_share` at a low likelihood.
HealthMonitor after_a_drop(const RecoveryConfig& config, double inlier_share) {
  HealthMonitor monitor(config);
  for (int n = 0; n < 50; ++n) monitor.add(1.0, {0.95, 1.0}, 0.05);
  for (int n = 0; n < 20; ++n) monitor.add(0.1, {inlier_share, 1.0}, 0.05);
  return monitor;
}

TEST(HealthMonitor, InjectsWhenLikelihoodDropsAndBeamsAreNotExplained) {
  EXPECT_GT(after_a_drop(kidnapping_recovery(), 0.2).injection_share(), 0.0);
}

TEST(HealthMonitor, KeepsASurePoseThatExplainsItsBeams) {
  const HealthMonitor monitor = after_a_drop(kidnapping_recovery(), 0.95);
  EXPECT_LT(monitor.health().likelihood_ratio, 0.8);
  EXPECT_EQ(monitor.injection_share(), 0.0);
}

TEST(HealthMonitor, NeverRecoversUnlessAsked) {
  const HealthMonitor monitor = after_a_drop({}, 0.2);
  EXPECT_EQ(monitor.health().state, HealthState::kLost);
  EXPECT_EQ(monitor.injection_share(), 0.0);
  EXPECT_FALSE(monitor.wants_restart());
}

/// A monitor that has seen a good pose for a while, and then scans of which the map judges little.
HealthMonitor after_leaving_the_map(const InlierShares& shares) {
  HealthMonitor monitor(kidnapping_recovery());
  for (int n = 0; n < 50; ++n) monitor.add(1.0, {0.95, 1.0}, 0.05);
  for (int n = 0; n < 60; ++n) monitor.add(0.1, shares, 0.05);
  return monitor;
}

TEST(HealthMonitor, CountsOnlyBeamsThatTheMapJudges) {
  EXPECT_EQ(after_leaving_the_map({0.56, 0.6}).health().state, HealthState::kGood);
  EXPECT_EQ(after_leaving_the_map({0.47, 0.6}).health().state, HealthState::kMapOutdated);
  EXPECT_EQ(after_leaving_the_map({0.2, 0.6}).health().state, HealthState::kLost);
}

TEST(HealthMonitor, CountsBeamsThatTheMapCannotJudgeAsUsualBeforeItIsLost) {
  EXPECT_EQ(after_leaving_the_map({0.335, 0.6}).health().state, HealthState::kMapOutdated);
  EXPECT_EQ(after_leaving_the_map({0.5, 1.0}).health().state, HealthState::kLost);
}

TEST(HealthMonitor, CallsTheMapOutdatedAndLooksForNothingWhereItJudgesFewBeams) {
  for (const double inlier : {0.0, 0.2, 0.4}) {
    const HealthMonitor monitor = after_leaving_the_map({inlier, 0.4});
    EXPECT_EQ(monitor.health().state, HealthState::kMapOutdated);
    EXPECT_EQ(monitor.injection_share(), 0.0);
    EXPECT_FALSE(monitor.wants_restart());
  }
  EXPECT_EQ(after_leaving_the_map({}).health().inlier_share, 1.0);
}

TEST(HealthMonitor, WeighsScansByTheBeamsThatTheMapJudges) {
  HealthMonitor monitor{RecoveryConfig{}};
  monitor.add(1.0, {0.9, 0.9}, 0.05);
  monitor.add(1.0, {0.0, 0.1}, 0.05);
  EXPECT_NEAR(monitor.health().inlier_share_fast, 0.9, 1e-12);
}

/// A monitor that has seen a good pose for a while, and then scans with half the beams inliers.
HealthMonitor after_half(double at_surface, double stopped) {
  HealthMonitor monitor(kidnapping_recovery());
  for (int n = 0; n < 50; ++n) monitor.add(1.0, {0.95, 1.0}, 0.05);
  InlierShares half(0.5, 1.0);
  half.at_surface = at_surface;
  half.stopped = stopped;
  for (int n = 0; n < 60; ++n) monitor.add(0.1, half, 0.05);
  return monitor;
}

TEST(HealthMonitor, IsLostWhenBeamsEndAnywhere) {
  EXPECT_EQ(after_half(0.5, 0.0).health().state, HealthState::kLost);
  EXPECT_EQ(after_half(0.5, 0.25).health().state, HealthState::kLost);
}

TEST(HealthMonitor, CallsTheMapOutdatedWhereBeamsGoOnToAnotherSurface) {
  EXPECT_EQ(after_half(0.8, 0.0).health().state, HealthState::kMapOutdated);
}

TEST(HealthMonitor, CallsTheMapOutdatedWhereOnlyBeamsThatAreStoppedAreNotExplained) {
  EXPECT_EQ(after_half(0.5, 0.48).health().state, HealthState::kMapOutdated);
}

TEST(HealthMonitor, IsLostWhereNearlyAllBeamsAreStopped) {
  HealthMonitor monitor{RecoveryConfig{}};
  for (int n = 0; n < 50; ++n) monitor.add(1.0, {0.95, 1.0}, 0.05);
  InlierShares few(0.15, 1.0);
  few.stopped = 0.85;
  for (int n = 0; n < 60; ++n) monitor.add(0.1, few, 0.05);
  EXPECT_EQ(monitor.health().state, HealthState::kLost);
}

TEST(HealthMonitor, LooksForABetterPlaceAlreadyWhereTheVerdictIsThatTheMapIsOutdated) {
  const HealthMonitor monitor = after_half(0.8, 0.0);
  EXPECT_NE(monitor.health().state, HealthState::kLost);
  EXPECT_TRUE(monitor.health().is_in_doubt);
  EXPECT_TRUE(monitor.wants_restart());
  EXPECT_GT(monitor.injection_share(), 0.0);
}

TEST(HealthMonitor, CallsTheMapOutdatedWhileScansAreNotWeighedSinceItSaysNothingOfThem) {
  HealthMonitor monitor = after_leaving_the_map({0.9, 1.0});
  ASSERT_EQ(monitor.health().state, HealthState::kGood);
  const double inlier_share = monitor.health().inlier_share_fast;
  monitor.add_unjudged(0.2, 0.05);
  EXPECT_EQ(monitor.health().state, HealthState::kGood) << "one scan is not enough";
  for (int n = 0; n < 30; ++n) monitor.add_unjudged(0.2, 0.05);
  EXPECT_EQ(monitor.health().state, HealthState::kMapOutdated);
  EXPECT_NEAR(monitor.health().judged_share_fast, 0.2, 0.05);
  for (int n = 0; n < 1000; ++n) monitor.add_unjudged(0.2, 0.05);
  EXPECT_NEAR(monitor.health().judged_share_fast, 0.2, 1e-9) << "never below what it judges";
  monitor.add(1.0, {0.9, 1.0}, 0.05);
  EXPECT_NEAR(monitor.health().inlier_share_fast, inlier_share, 1e-3) << "what was usual stays";
  for (int n = 0; n < 40; ++n) monitor.add(1.0, {0.9, 1.0}, 0.05);
  EXPECT_EQ(monitor.health().state, HealthState::kGood);
}

TEST(HealthMonitor, TellsTheSpreadWhileScansAreNotWeighed) {
  HealthMonitor monitor = after_leaving_the_map({0.9, 1.0});
  monitor.add_unjudged(0.0, 0.7);
  EXPECT_EQ(monitor.health().state, HealthState::kConverging);
  EXPECT_EQ(monitor.health().position_stddev_m, 0.7);
}

TEST(HealthMonitor, WhatWasLostStaysSoWhileScansAreNotWeighed) {
  HealthMonitor monitor = after_leaving_the_map({0.2, 0.6});
  ASSERT_EQ(monitor.health().state, HealthState::kLost);
  for (int n = 0; n < 100; ++n) monitor.add_unjudged(0.0, 0.7);
  EXPECT_EQ(monitor.health().state, HealthState::kLost);
  EXPECT_TRUE(monitor.health().is_in_doubt);
}

TEST(HealthMonitor, SaysThatFewAreJudgedBeforeAnyScanWasWeighed) {
  HealthMonitor monitor{RecoveryConfig{}};
  monitor.add_unjudged(0.3, 0.05);
  EXPECT_NE(monitor.health().state, HealthState::kGood);
}

/// How many of 100,000 values at a pose that went wrong pass until it counts as usual; -1 if never.
int values_until_not_lost() {
  HealthMonitor monitor{RecoveryConfig{}};
  for (int n = 0; n < 1000; ++n) monitor.add(1.0, {0.95, 1.0}, 0.05);
  InlierShares wrong(0.3, 1.0);
  wrong.at_surface = 0.45;
  wrong.stopped = 0.4;
  bool was_lost = false;
  for (int n = 0; n < 100'000; ++n) {
    monitor.add(0.1, wrong, 0.05);
    const bool is_lost = monitor.health().state == HealthState::kLost;
    if (was_lost && !is_lost) return n;
    was_lost = is_lost;
  }
  return -1;
}

TEST(HealthMonitor, StaysLostWhileNothingGetsBetterButNotForEver) {
  EXPECT_GT(values_until_not_lost(), 2000);
}

/// Values in which nothing is an inlier, until a search is wanted.
int lost_values_until_restart(HealthMonitor& monitor) {
  int values = 0;
  while (!monitor.wants_restart() && values < 1000) {
    monitor.add(0.1, {0.2, 1.0}, 0.05);
    ++values;
  }
  return values;
}

TEST(HealthMonitor, LetsASearchComeToItsEndBeforeTheNext) {
  HealthMonitor monitor = after_a_drop(kidnapping_recovery(), 0.2);
  ASSERT_TRUE(monitor.wants_restart());
  monitor.search_begins(32);
  EXPECT_EQ(monitor.injection_share(), 0.0);
  EXPECT_EQ(lost_values_until_restart(monitor), 32 + 5);
}

TEST(HealthMonitor, ScansThatTheMapCannotJudgeEndNoSearch) {
  HealthMonitor monitor = after_a_drop(kidnapping_recovery(), 0.2);
  monitor.search_begins(32);
  for (int n = 0; n < 10; ++n) monitor.add(0.1, {0.0, 0.0}, 3.0);
  EXPECT_EQ(monitor.injection_share(), 0.0);
  EXPECT_GE(lost_values_until_restart(monitor), 32 - 10 + 5);
}

TEST(HealthMonitor, SearchesAgainSoonAfterASearchThatEndedEarlyAtAWrongPlace) {
  HealthMonitor monitor = after_a_drop(kidnapping_recovery(), 0.2);
  monitor.search_begins(32);
  monitor.add(0.1, {0.2, 1.0}, 0.05);
  monitor.search_ends();
  EXPECT_EQ(monitor.injection_share(), 0.0);
  EXPECT_EQ(lost_values_until_restart(monitor), 10 + 5);
}

TEST(HealthMonitor, GivesARightPlaceTheTimeToShowBeforeItSearchesAgain) {
  HealthMonitor monitor = after_a_drop(kidnapping_recovery(), 0.2);
  monitor.search_begins(32);
  monitor.search_ends();
  for (int n = 0; n < 40; ++n) {
    monitor.add(1.0, {0.95, 1.0}, 0.05);
    EXPECT_FALSE(monitor.wants_restart());
  }
}

}  // namespace
}  // namespace strata::localization
