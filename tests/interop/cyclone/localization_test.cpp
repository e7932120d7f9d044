// SPDX-License-Identifier: Apache-2.0
/// The localizer's services asked by Cyclone DDS in the way of rmw_cyclonedds.
#include <gtest/gtest.h>

#include "tests/components/localizer/live_fixture.hpp"
#include "tests/interop/cyclone/process.hpp"

namespace strata::test {
namespace {

class CycloneLocalization : public localizer::LiveLocalizer {};

TEST_F(CycloneLocalization, IsStartedAnywhereAndAtAPose) {
  const double settled_m2 = next_pose().pose().covariance()[0];
  CycloneProcess anywhere({"empty", "", "reinitialize_global_localization"});
  ASSERT_EQ(anywhere.wait_for_line("done"), "done");
  const double spread_m2 = next_pose().pose().covariance()[0];
  EXPECT_GT(spread_m2, 0.25);
  EXPECT_GT(spread_m2, 10.0 * settled_m2);
  const Pose2 there{5.5, 3.5, 0.0};
  CycloneProcess at_a_pose({"set_initial_pose", "", "5.5", "3.5"});
  ASSERT_EQ(at_a_pose.wait_for_line("posed"), "posed");
  const auto posed = next_pose();
  EXPECT_LT(translation_distance(planar(convert::from_message(posed.pose().pose())), there), 0.5);
  EXPECT_LT(posed.pose().covariance()[0], 0.25);
  EXPECT_TRUE(host_->take_errors().empty());
}

}  // namespace
}  // namespace strata::test
