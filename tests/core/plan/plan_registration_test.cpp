// SPDX-License-Identifier: Apache-2.0
#include "core/plan/plan_registration.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/geometry/angle.hpp"
#include "tests/core/plan/painted.hpp"

namespace strata::plan {
namespace {

using test::building;
using test::drawn;
using test::hall;
using test::seen;

/// Over the building, which lies elsewhere in the plan.
double off_m(const SiteFromPlan& found, const SiteFromPlan& truth) {
  double most_m = 0.0;
  for (const auto& line : building()) {
    const Eigen::Vector2d in_plan = inverse(truth.pose) * line.a / truth.scale;
    most_m = std::max(most_m, (found * in_plan - line.a).norm());
  }
  return most_m;
}

TEST(PlanRegistration, FindsLinesHoweverTheyAreTurned) {
  for (const double turn : {0.0, 0.4, 1.7, -2.9}) {
    const SiteFromPlan truth{{2.3, -1.1, turn}, 1.0};
    const PlanRegistration found = register_plan(drawn(building(), truth), seen(building()));
    EXPECT_EQ(found.verdict, PlanVerdict::kGood) << turn;
    EXPECT_LT(off_m(found.best.site_from_plan, truth), 0.02) << turn;
    EXPECT_LT(std::abs(angle_difference(found.best.site_from_plan.pose.theta, turn)), 0.002);
    EXPECT_GT(found.best.map_share, 0.7);
    EXPECT_LT(found.best.map_share, 0.98) << "the cupboards are no walls of the plan";
  }
}

TEST(PlanRegistration, DoesNotMindHowThickWallsAreDrawn) {
  const SiteFromPlan truth{{-1.0, 0.7, 0.9}, 1.0};
  const PlanRegistration found = register_plan(drawn(building(), truth, 0.2), seen(building()));
  EXPECT_EQ(found.verdict, PlanVerdict::kGood);
  EXPECT_LT(off_m(found.best.site_from_plan, truth), 0.02);
  EXPECT_NEAR(found.best.thicker_m, -0.2, 0.04);
}

TEST(PlanRegistration, SaysThatTheScaleIsWrong) {
  const SiteFromPlan truth{{0.5, 0.2, 0.3}, 1.012};
  const auto plan = drawn(building(), truth);
  const PlanRegistration found = register_plan(plan, seen(building()));
  EXPECT_EQ(found.verdict, PlanVerdict::kGood);
  EXPECT_NEAR(found.best.site_from_plan.scale, 1.012, 0.003);
  EXPECT_LT(off_m(found.best.site_from_plan, truth), 0.03);
  PlanConfig as_said;
  as_said.keeps_scale = true;
  const PlanRegistration kept = register_plan(plan, seen(building()), {}, as_said);
  EXPECT_EQ(kept.best.site_from_plan.scale, 1.0);
  EXPECT_GT(off_m(kept.best.site_from_plan, truth), 0.02);
}

TEST(PlanRegistration, RefusesAScaleThatIsFarOff) {
  for (const double scale : {1.03, 0.97, 1.3}) {
    const PlanRegistration found =
        register_plan(drawn(building(), {{0.5, 0.2, 0.3}, scale}), seen(building()));
    EXPECT_NE(found.verdict, PlanVerdict::kGood) << scale;
  }
  EXPECT_EQ(register_plan(drawn(building(), {{0.5, 0.2, 0.3}, 1.025}), seen(building())).verdict,
            PlanVerdict::kWrongScale);
}

TEST(PlanRegistration, AsksWhereABuildingIsTheSameAfterHalfATurn) {
  const SiteFromPlan truth{{1.0, 2.0, 0.3}, 1.0};
  const auto plan = drawn(hall(), truth);
  const auto map = seen(hall(), false);
  const PlanRegistration found = register_plan(plan, map);
  EXPECT_EQ(found.verdict, PlanVerdict::kAmbiguous);
  ASSERT_TRUE(found.rival);
  EXPECT_NEAR(found.rival->score, found.best.score, 0.05);
  EXPECT_NEAR(std::abs(angle_difference(found.rival->site_from_plan.pose.theta,
                                        found.best.site_from_plan.pose.theta)),
              3.14159, 0.01);
  PlanConfig config;
  for (const double guessed : {0.45, 0.45 + 3.14159}) {
    const Pose2 half_turn{0.0, 0.0, guessed - 0.45};
    const SiteFromPlan right{half_turn * truth.pose, 1.0};
    config.near = Pose2{right.pose.x + 0.8, right.pose.y - 0.6, guessed};
    const PlanRegistration near = register_plan(plan, map, {}, config);
    EXPECT_EQ(near.verdict, PlanVerdict::kGood) << guessed;
    EXPECT_LT(off_m(near.best.site_from_plan, right), 0.03) << guessed;
  }
}

TEST(PlanRegistration, LooksNowhereElseThanNearTheGuess) {
  const SiteFromPlan truth{{1.0, 2.0, 0.3}, 1.0};
  PlanConfig config;
  config.near = Pose2{1.0, -7.0, 0.3};  // 9 m off
  EXPECT_NE(register_plan(drawn(building(), truth), seen(building()), {}, config).verdict,
            PlanVerdict::kGood);
  const SiteFromPlan far{{3.5, 0.0, 0.3}, 1.0};
  config.near = Pose2{7.7, 0.0, 0.3};  // 4.2 m off
  EXPECT_NE(register_plan(drawn(building(), far), seen(building()), {}, config).verdict,
            PlanVerdict::kGood);
  config.near = Pose2{1.5, 1.0, 0.6};
  EXPECT_EQ(register_plan(drawn(building(), truth), seen(building()), {}, config).verdict,
            PlanVerdict::kGood);
}

TEST(PlanRegistration, RefusesAnotherBuilding) {
  std::vector<test::Line> other;
  test::add_box(other, -4.0, -4.0, 0.0, 4.5);
  test::add_box(other, 0.0, -1.0, 5.5, 1.0);
  const PlanRegistration found = register_plan(drawn(other, {}), seen(building()));
  EXPECT_NE(found.verdict, PlanVerdict::kGood);
}

TEST(PlanRegistration, SaysWhatIsEmpty) {
  const ReflectionGrid nothing = make_reflection_grid(0.05, {});
  EXPECT_EQ(register_plan(drawn({}, {}), seen(building())).verdict, PlanVerdict::kNothingDrawn);
  EXPECT_EQ(register_plan(nothing, seen(building())).verdict, PlanVerdict::kNothingDrawn);
  EXPECT_EQ(register_plan(drawn(building(), {}), nothing).verdict, PlanVerdict::kNothingSeen);
  EXPECT_EQ(register_plan(drawn(building(), {}), seen({}, false)).verdict,
            PlanVerdict::kNothingSeen);
}

}  // namespace
}  // namespace strata::plan
