// SPDX-License-Identifier: Apache-2.0
#include "core/localization/start_confirmation.hpp"

#include <gtest/gtest.h>

#include "core/localization/localizer.hpp"
#include "core/localization/range_provider_model.hpp"
#include "tests/core/localization/box_world.hpp"

namespace strata::localization {
namespace {

using test::BoxWorld;
using test::Drive;

constexpr StartConfirmationConfig kConfirmation{
    .confirmed_score = 0.6, .refuted_score = 0.3, .search_again_scans = 5};

/// Of so many scans of that score, after which a search is asked for; 0 for none.
int asked_after(StartConfirmation& confirmation, double score, int scans) {
  for (int n = 1; n <= scans; ++n) {
    if (confirmation.judge(score)) return n;
  }
  return 0;
}

TEST(StartConfirmation, AsksNothingOfAPoseThatSomebodyGave) {
  StartConfirmation confirmation(kConfirmation);
  EXPECT_FALSE(confirmation.is_pending());
  EXPECT_EQ(asked_after(confirmation, 0.0, 50), 0);
  EXPECT_FALSE(confirmation.is_pending());
  confirmation.search();
  confirmation.tell();
  EXPECT_EQ(asked_after(confirmation, 0.0, 50), 0);
  EXPECT_FALSE(confirmation.is_pending());
}

TEST(StartConfirmation, IsPendingUntilTheScoreIsHigh) {
  StartConfirmation confirmation(kConfirmation);
  confirmation.search();
  EXPECT_FALSE(confirmation.judge(0.59));
  EXPECT_TRUE(confirmation.is_pending());
  EXPECT_FALSE(confirmation.judge(0.6));
  EXPECT_FALSE(confirmation.is_pending());
}

TEST(StartConfirmation, SearchesAgainMoreAndMoreRarelyWhileTheScoreIsLow) {
  StartConfirmation confirmation(kConfirmation);
  confirmation.search();
  for (const int scans : {5, 10, 20}) {
    EXPECT_EQ(asked_after(confirmation, 0.2, 100), scans);
    confirmation.search();
  }
}

TEST(StartConfirmation, LeavesAPlaceBeThatFitsSomewhat) {
  StartConfirmation confirmation(kConfirmation);
  confirmation.search();
  EXPECT_EQ(asked_after(confirmation, 0.4, 50), 0);
  EXPECT_TRUE(confirmation.is_pending());
  EXPECT_EQ(asked_after(confirmation, 0.2, 50), 1) << "the wait is over already";
}

TEST(StartConfirmation, OfALaterSearchWaitsAnew) {
  StartConfirmation confirmation(kConfirmation);
  confirmation.search();
  EXPECT_EQ(asked_after(confirmation, 0.2, 50), 5);
  confirmation.search();
  ASSERT_FALSE(confirmation.judge(0.9));
  EXPECT_EQ(asked_after(confirmation, 0.0, 50), 0) << "what is believed is watched by another";
  confirmation.search();
  EXPECT_TRUE(confirmation.is_pending());
  EXPECT_EQ(asked_after(confirmation, 0.2, 50), 5);
}

/// A map of a room, and a robot in another one that is larger and furnished otherwise.
TEST(StartConfirmation, IsWithheldFromTheLeastWrongPlaceOfAMapThatDoesNotHaveTheRoom) {
  const BoxWorld mapped{{0.0, 0.0, 6.0, 0.4},
                        {0.0, 3.6, 6.0, 4.0},
                        {0.0, 0.0, 0.4, 4.0},
                        {5.6, 0.0, 6.0, 4.0},
                        {1.0, 0.4, 1.6, 1.3}};
  const BoxWorld room{{0.0, 0.0, 7.2, 0.4}, {0.0, 4.4, 7.2, 4.8}, {0.0, 0.0, 0.4, 4.8},
                      {6.8, 0.0, 7.2, 4.8}, {1.2, 0.4, 1.9, 1.2}, {4.6, 3.5, 5.4, 4.4}};
  const ReflectionGrid map = test::rasterize(mapped, 0.05, {{0, 0}, {120, 80}});
  LocalizerConfig config;
  config.global_search.is_used = true;
  bool is_one_left = false;
  bool is_sought_again = false;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Localizer localizer(config, make_grid_beam_model(map), seed, 1);
    localizer.initialize_global(map);
    Drive drive({2.6, 2.6, 0.4}, 70 + seed);
    for (int n = 0; n < 120; ++n) {
      drive.step({0.02, 0.0, 0.12});
      const LocalizationResult result = localizer.update(drive.look(room, 4.0, 60));
      EXPECT_TRUE(result.is_ambiguous) << seed << ", " << n;
      EXPECT_FALSE(result.converged) << seed << ", " << n;
      is_sought_again |= is_one_left && result.places.size() > 1;
      if (result.places.size() != 1) continue;
      is_one_left = true;
      EXPECT_LT(result.places.front().probability, 0.6);
      EXPECT_NE(result.health.state, HealthState::kGood);
    }
    EXPECT_TRUE(is_one_left) << "nothing was withheld";
    EXPECT_TRUE(is_sought_again);
    is_one_left = is_sought_again = false;
    localizer.initialize({{2.6, 2.6, 0.4}, Eigen::Vector3d(0.01, 0.01, 0.001).asDiagonal()});
    EXPECT_FALSE(localizer.update(drive.look(room, 4.0, 60)).is_ambiguous) << "somebody said where";
  }
}

}  // namespace
}  // namespace strata::localization
