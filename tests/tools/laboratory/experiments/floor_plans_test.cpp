// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/floor_plans.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "core/plan/plan_registration.hpp"
#include "tools/laboratory/experiments/drawn_plan.hpp"
#include "tools/simulate/random_floor.hpp"

namespace strata::experiments {
namespace {

simulate::ScenarioConfig floor_of(std::uint64_t seed) {
  simulate::RandomFloorOptions options;
  options.days = 3;
  return simulate::random_floor(seed, options);
}

/// One whose plan shows all of it.
TEST(FloorPlanTrials, PutAPlanWhereItLiesAndARobotOnIt) {
  const PlanOutcome outcome = try_plan(floor_of(4), floor_of(1004), 4);
  EXPECT_EQ(outcome.verdict, static_cast<double>(plan::PlanVerdict::kGood));
  EXPECT_LT(outcome.error_m, 0.05);
  EXPECT_LT(outcome.error_deg, 0.3);
  EXPECT_GE(outcome.worst_m, outcome.error_m);
  EXPECT_NE(outcome.foreign_verdict, static_cast<double>(plan::PlanVerdict::kGood));
  EXPECT_EQ(outcome.lost, 0.0);
  EXPECT_LT(outcome.localized_m, 0.2);
}

TEST(FloorPlanTrials, DrawFromTheSeedAlone) {
  const simulate::Simulation building = simulate::simulate(floor_of(4), 4);
  const DrawnPlan plan = draw_plan(building, 7);
  EXPECT_EQ(plan.drawing.values(), draw_plan(building, 7).drawing.values());
  EXPECT_NE(plan.site_from_plan.pose.theta, draw_plan(building, 8).site_from_plan.pose.theta);
  EXPECT_LE(std::abs(plan.site_from_plan.scale - 1.0), 0.005);
  // The ends of the outer walls are drawn where the truth says.
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d at =
        inverse(plan.site_from_plan.pose) * building.walls[i].a / plan.site_from_plan.scale;
    const Cell cell = plan.drawing.cell_at(at);
    const auto is_drawn = [&](const Cell& other) { return plan.drawing.get(other) == 1.0F; };
    EXPECT_TRUE(plan.is_cut || plan.thick_m > 0.0 || any_beside(cell, is_drawn)) << i;
  }
}

}  // namespace
}  // namespace strata::experiments
