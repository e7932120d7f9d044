// SPDX-License-Identifier: Apache-2.0
#include "core/plan/plan_map.hpp"

#include <gtest/gtest.h>

#include "tests/core/plan/painted.hpp"

namespace strata::plan {
namespace {

TEST(PlanMap, LiesInTheFrameOfTheSite) {
  std::vector<test::Line> lines;
  test::add_box(lines, -5.0, -3.0, 5.0, 3.0);
  lines.erase(lines.begin());
  lines.push_back({{-5.0, -3.0}, {0.0, -3.0}});
  lines.push_back({{0.9, -3.0}, {5.0, -3.0}});  // an entrance
  const SiteFromPlan site_from_plan{{3.0, -2.0, 0.7}, 1.01};
  const ReflectionGrid map = map_of_plan(test::drawn(lines, site_from_plan), site_from_plan, 0.05);
  const auto value = [&](double x, double y) { return map.get(map.cell_at({x, y})); };
  EXPECT_TRUE(is_occupied(value(2.0, 3.0)));
  EXPECT_TRUE(is_occupied(value(-5.0, 1.0)));
  EXPECT_TRUE(is_free(value(0.0, 0.0)));
  EXPECT_TRUE(is_free(value(0.45, -2.8))) << "inside of the entrance";
  EXPECT_FALSE(is_known(value(0.0, -5.0))) << "outside";
  EXPECT_FALSE(is_known(value(6.5, 0.0)));
}

}  // namespace
}  // namespace strata::plan
