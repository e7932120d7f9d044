// SPDX-License-Identifier: Apache-2.0
#include "components/localizer/health_report.hpp"

#include <gmock/gmock.h>

namespace strata::localizer {
namespace {

using localization::HealthState;
using runtime::HealthLevel;
using testing::Contains;
using testing::Pair;

runtime::Health described(HealthState state, bool converged) {
  localization::LocalizationResult result;
  result.health.state = state;
  result.health.judged_share_fast = 0.25;
  result.score = 0.625;
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

TEST(HealthReport, TellsTheVerdictAndWhatItRestsOn) {
  const runtime::Health health = described(HealthState::kMapOutdated, true);
  EXPECT_THAT(health.values(), Contains(Pair("verdict", "map_outdated")));
  EXPECT_THAT(health.values(), Contains(Pair("judged_share", "0.25")));
  EXPECT_THAT(health.values(), Contains(Pair("score", "0.625")));
}

TEST(HealthReport, IsNotLocalizedInAMessageWhenLostOrSpreadWidely) {
  localization::LocalizationResult result;
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
