// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/localize_output.hpp"

#include <gtest/gtest.h>

#include "tests/support/test_data.hpp"

namespace strata::pipeline {
namespace {

TEST(LocalizeOutput, TellsOfEachTenthOfTheScoreWhatShareWasWrong) {
  LocalizationRun run;
  for (const auto& [score, error_m] :
       {std::pair(1.0, 0.1), std::pair(0.95, 0.6), std::pair(0.9, 0.2), std::pair(0.05, 3.0)}) {
    run.trajectory.emplace_back();
    run.scores.push_back(score);
    run.errors.push_back({Stamp{}, error_m, 0.0, score});
  }
  run.trajectory.emplace_back();  // of this one the truth is not known
  run.scores.push_back(0.31);
  run.place_scores = {1.0, 1.0, 0.9, 0.1, 0.5};
  const test::TemporaryDirectory folder;
  const nlohmann::json score = write_localization(folder.path(), run, {})["score"];
  EXPECT_NEAR(score["place_mean"], 0.7, 1e-12);
  EXPECT_NEAR(score["mean"], (1.0 + 0.95 + 0.9 + 0.05 + 0.31) / 5.0, 1e-12);
  ASSERT_EQ(score["bins"].size(), 10U);
  EXPECT_EQ(score["bins"][9], nlohmann::json({0.9, 1.0, 3, 1.0 / 3.0}));
  EXPECT_EQ(score["bins"][0], nlohmann::json({0.0, 0.1, 1, 1.0}));
  EXPECT_EQ(score["bins"][3][2], 1);
  EXPECT_TRUE(score["bins"][3][3].is_null());
  EXPECT_EQ(score["bins"][5][2], 0);
}

TEST(LocalizeOutput, OfNoScanTheScoreHasNoMean) {
  const test::TemporaryDirectory folder;
  const nlohmann::json score = write_localization(folder.path(), LocalizationRun(), {})["score"];
  EXPECT_TRUE(score["mean"].is_null());
  EXPECT_TRUE(score["place_mean"].is_null());
  EXPECT_EQ(score["bins"].size(), 10U);
}

}  // namespace
}  // namespace strata::pipeline
