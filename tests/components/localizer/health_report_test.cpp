// SPDX-License-Identifier: Apache-2.0
#include "components/localizer/health_report.hpp"

#include <cmath>
#include <random>

#include <gmock/gmock.h>

namespace strata::localizer {
namespace {

using localization::HealthState;
using runtime::HealthLevel;
using testing::Contains;
using testing::Pair;

runtime::Health described(HealthState state, bool converged, double score = 0.625) {
  localization::LocalizationResult result;
  result.health.state = state;
  result.health.judged_share_fast = 0.25;
  result.score = score;
  result.converged = converged;
  runtime::Health health;
  describe(make_health_report("filtered", result, {}), health);
  return health;
}

TEST(HealthReport, SeparatesALostRobotFromAnOutdatedMap) {
  EXPECT_EQ(described(HealthState::kLost, true).level(), HealthLevel::kError);
  EXPECT_EQ(described(HealthState::kLost, true).message(), "lost");
  EXPECT_EQ(described(HealthState::kMapOutdated, true).level(), HealthLevel::kWarn);
  EXPECT_EQ(described(HealthState::kMapOutdated, true).message(), "the map is outdated here");
  EXPECT_EQ(described(HealthState::kConverging, false).message(), "not localized yet");
  EXPECT_EQ(described(HealthState::kGood, true).level(), HealthLevel::kOk);
}

TEST(HealthReport, SaysWhyAPoseIsAmbiguous) {
  localization::LocalizationResult result;
  result.is_ambiguous = true;
  result.health.state = HealthState::kConverging;
  for (const char* why :
       {"ambiguous: no place has been found yet",
        "ambiguous: the place that is left is not confirmed yet",
        "ambiguous: several places are possible", "ambiguous: several places are possible"}) {
    runtime::Health health;
    describe(make_health_report("filtered", result, {}), health);
    EXPECT_EQ(health.level(), HealthLevel::kWarn);
    EXPECT_EQ(health.message(), why);
    result.places.emplace_back();
  }
}

TEST(HealthReport, FollowsTheScoreWhereNothingInTheMapContradictsThePose) {
  for (const HealthState state : {HealthState::kMapOutdated, HealthState::kGood}) {
    const runtime::Health wrong = described(state, true, 0.03);
    EXPECT_EQ(wrong.level(), HealthLevel::kWarn);
    EXPECT_THAT(wrong.message(), testing::HasSubstr("probably wrong"));
    EXPECT_THAT(wrong.values(), Contains(Pair("localized", "false")));
    EXPECT_THAT(wrong.values(), Contains(Pair("probably_wrong", "true")));
  }
  const runtime::Health right = described(HealthState::kMapOutdated, true, 0.15);
  EXPECT_EQ(right.message(), "the map is outdated here");
  EXPECT_THAT(right.values(), Contains(Pair("localized", "true")));
  EXPECT_THAT(right.values(), Contains(Pair("probably_wrong", "false")));
  // Who is lost, or looks for itself, is told so.
  EXPECT_EQ(described(HealthState::kLost, true, 0.03).message(), "lost");
  EXPECT_EQ(described(HealthState::kConverging, false, 0.03).message(), "not localized yet");
}

TEST(HealthReport, SaysThatTheRobotIsBeyondTheMapUnlessWorseIsToBeSaid) {
  localization::LocalizationResult result;
  result.converged = true;
  result.score = 0.5;
  result.is_beyond_map = true;
  result.health.state = HealthState::kMapOutdated;
  runtime::Health beyond;
  describe(make_health_report("filtered", result, {}), beyond);
  EXPECT_EQ(beyond.level(), HealthLevel::kWarn);
  EXPECT_THAT(beyond.message(), testing::HasSubstr("beyond the map"));
  EXPECT_THAT(beyond.values(), Contains(Pair("beyond_map", "true")));
  result.health.state = HealthState::kLost;
  runtime::Health lost;
  describe(make_health_report("filtered", result, {}), lost);
  EXPECT_EQ(lost.message(), "lost");
  EXPECT_THAT(described(HealthState::kGood, true).values(), Contains(Pair("beyond_map", "false")));
}

TEST(HealthReport, SaysThatADoubtedRobotIsLookedForUnlessWorseIsToBeSaid) {
  localization::LocalizationResult result;
  result.converged = true;
  result.score = 0.2;
  result.is_recovering = true;
  runtime::Health doubted;
  describe(make_health_report("filtered", result, {}), doubted);
  EXPECT_EQ(doubted.level(), HealthLevel::kWarn);
  EXPECT_THAT(doubted.message(), testing::HasSubstr("looked for elsewhere"));
  EXPECT_THAT(doubted.values(), Contains(Pair("recovering", "true")));
  result.score = 0.03;
  runtime::Health wrong;
  describe(make_health_report("filtered", result, {}), wrong);
  EXPECT_THAT(wrong.message(), testing::HasSubstr("probably wrong"));
  EXPECT_THAT(described(HealthState::kGood, true).values(), Contains(Pair("recovering", "false")));
}

TEST(HealthReport, TellsTheVerdictAndWhatItRestsOn) {
  const runtime::Health health = described(HealthState::kMapOutdated, true);
  EXPECT_THAT(health.values(), Contains(Pair("verdict", "map_outdated")));
  EXPECT_THAT(health.values(), Contains(Pair("judged_share", "0.25")));
  EXPECT_THAT(health.values(), Contains(Pair("score", "0.625")));
}

TEST(HealthReport, NamesItsFiguresAsVda5050Does) {
  const runtime::Health good = described(HealthState::kGood, true);
  EXPECT_THAT(good.values(), Contains(Pair("localizationScore", "0.625")));
  EXPECT_THAT(good.values(), Contains(Pair("localized", "true")));
  EXPECT_THAT(described(HealthState::kMapOutdated, true).values(),
              Contains(Pair("localized", "true")));
  EXPECT_THAT(described(HealthState::kLost, true).values(), Contains(Pair("localized", "false")));
  EXPECT_THAT(described(HealthState::kGood, false).values(), Contains(Pair("localized", "false")));
  runtime::Health before;
  describe_unknown_place(before);
  EXPECT_THAT(before.values(),
              testing::ElementsAre(Pair("localizationScore", "0"), Pair("localized", "false")));
}

TEST(HealthReport, HasADeviationRangeThatHoldsThePoseWithNinetyFivePercent) {
  // Longest across the axes: 0.4 m along a diagonal, 0.1 m beside it.
  localization::LocalizationResult result;
  result.pose.covariance.topLeftCorner<2, 2>() << 0.085, 0.075, 0.075, 0.085;
  const double range_m = make_health_report("patch", result, {}).deviation_range_m;
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  const auto share_within = [&](double along_m, double beside_m) {
    int within = 0;
    constexpr int kDraws = 100'000;
    for (int i = 0; i < kDraws; ++i) {
      const double a = along_m * normal(random);
      const double b = beside_m * normal(random);
      if (std::hypot(a, b) <= range_m) ++within;
    }
    return static_cast<double>(within) / kDraws;
  };
  EXPECT_NEAR(share_within(0.4, 0.4), 0.95, 0.003) << "as wide in all directions";
  EXPECT_GT(share_within(0.4, 0.1), 0.95);
  EXPECT_NEAR(range_m, 0.979, 0.001);
}

TEST(HealthReport, IsNotLocalizedInAMessageWhenLostOrSpreadWidely) {
  localization::LocalizationResult result;
  result.score = 0.8;
  const auto message = [&](HealthState state, bool converged) {
    result.health.state = state;
    result.converged = converged;
    return to_message(make_health_report("patch", result, {}), Stamp{}, "map");
  };
  EXPECT_TRUE(message(HealthState::kGood, true).localized());
  EXPECT_TRUE(message(HealthState::kMapOutdated, true).localized());
  EXPECT_FALSE(message(HealthState::kGood, false).localized());
  EXPECT_FALSE(message(HealthState::kLost, true).localized());
  EXPECT_TRUE(message(HealthState::kLost, true).lost());
}

}  // namespace
}  // namespace strata::localizer
