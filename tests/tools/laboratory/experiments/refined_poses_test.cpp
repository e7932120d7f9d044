// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/refined_poses.hpp"

#include <gtest/gtest.h>

#include "tools/simulate/simulation.hpp"

namespace strata::experiments {
namespace {

TEST(RefinedPoses, AreACentimetreOffInAnOfficeWithChangesThatSlamMapped) {
  simulate::ScenarioConfig office =
      simulate::load_scenario(STRATA_SCENARIO_DIR "/office.yaml", {"days=2"});
  for (const auto& [model, outcome] : refine_last_day(office, 104)) {
    EXPECT_GT(outcome.refined, 0.9 * outcome.scans) << model;
    EXPECT_LT(outcome.refined_m, 0.015) << model;
    EXPECT_LT(outcome.refined_m, 0.6 * outcome.filtered_m) << model;
    EXPECT_LT(outcome.refined_p95_m, 0.03) << model;
    EXPECT_LT(outcome.mahalanobis_squared, 4.0) << model << " does not know how far off it is";
  }
}

}  // namespace
}  // namespace strata::experiments
