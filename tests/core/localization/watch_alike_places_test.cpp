// SPDX-License-Identifier: Apache-2.0
/// The search beside a pose that is doubted, in a room that looks the same turned by half a turn.
#include <algorithm>
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include "core/localization/localizer.hpp"
#include "core/localization/range_provider_model.hpp"
#include "tests/core/localization/box_world.hpp"

namespace strata::localization {
namespace {

constexpr double kWidth_m = 8.0;
constexpr double kDepth_m = 5.0;

/// What a localizer with a wrong start says, and where the robot is.
struct Told {
  LocalizationResult result;
  Pose2 truth;
};

std::vector<Told> told_from_a_wrong_start(int scans) {
  const test::BoxWorld room = {{0.0, 0.0, kWidth_m, 0.4},
                               {0.0, kDepth_m - 0.4, kWidth_m, kDepth_m},
                               {0.0, 0.0, 0.4, kDepth_m},
                               {kWidth_m - 0.4, 0.0, kWidth_m, kDepth_m}};
  const ReflectionGrid map = test::rasterize(room, 0.05, {{0, 0}, {160, 100}});
  Localizer localizer(LocalizerConfig{}, make_grid_beam_model(map), 4, 1);
  localizer.set_free_space(map);
  test::Drive drive({2.0, 1.5, 0.3}, 68);
  localizer.initialize({{4.0, 2.5, -1.2}, Eigen::Vector3d(0.01, 0.01, 0.01).asDiagonal()});
  std::vector<Told> told;
  for (int n = 0; n < scans; ++n) {
    drive.step({0.04, 0.0, 0.03});
    told.push_back({localizer.update(drive.look(room, 10.0, 60)), drive.truth()});
  }
  return told;
}

TEST(LocalizerWatch, TellsOfPlacesThatLookAlikeWhereItCannotDecide) {
  std::size_t ambiguous = 0;
  for (const auto& [result, truth] : told_from_a_wrong_start(60)) {
    if (!result.is_ambiguous) continue;
    ++ambiguous;
    EXPECT_NE(result.health.state, HealthState::kGood) << ambiguous;
    double nearest_m = 100.0;
    for (const PlaceBelief& place : result.places) {
      nearest_m = std::min(nearest_m, translation_distance(place.map_from_robot, truth));
    }
    EXPECT_LT(nearest_m, 0.3) << ambiguous;
  }
  EXPECT_GT(ambiguous, 40U);
}

TEST(LocalizerWatch, TellsOnceHowFarAnotherPlaceIsFromThePoseThatItReplaces) {
  std::size_t relocations = 0;
  Pose2 before;
  for (const auto& [result, truth] : told_from_a_wrong_start(60)) {
    if (result.relocated_m) {
      ++relocations;
      EXPECT_NEAR(*result.relocated_m, translation_distance(before, result.pose.mean), 0.3);
      EXPECT_GT(*result.relocated_m, 0.5);
    }
    before = result.pose.mean;
  }
  EXPECT_EQ(relocations, 1U);
}

TEST(LocalizerWatch, GivesUpAPoseThatIsNoneOfSeveralPlacesThatFit) {
  const std::vector<Told> told = told_from_a_wrong_start(60);
  for (std::size_t n = 30; n < told.size(); ++n) {
    const auto& [result, truth] = told[n];
    const Pose2 turned{kWidth_m - truth.x, kDepth_m - truth.y, truth.theta};
    EXPECT_LT(std::min(translation_distance(result.pose.mean, truth),
                       translation_distance(result.pose.mean, turned)),
              0.3)
        << n;
    EXPECT_TRUE(result.is_ambiguous) << n;
    EXPECT_FALSE(result.converged) << n;
    EXPECT_EQ(result.places.size(), 2U) << n;
  }
}

}  // namespace
}  // namespace strata::localization
