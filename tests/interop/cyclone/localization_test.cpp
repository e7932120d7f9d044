// SPDX-License-Identifier: Apache-2.0
/// The localizer's services asked by Cyclone DDS in the way of rmw_cyclonedds.
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "components/convert/map_messages.hpp"
#include "tests/components/localizer/door_fixture.hpp"
#include "tests/components/localizer/site_fixture.hpp"
#include "tests/interop/cyclone/process.hpp"

namespace strata::test {
namespace {

class CycloneLocalization : public localizer::LiveLocalizer {};
class CycloneCostmap : public localizer::LiveDoor {};
class CycloneZones : public localizer::LiveSite {};

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

TEST_F(CycloneLocalization, TellsItsLastPoseToWhoComesLate) {
  const Pose2 last = planar(convert::from_message(next_pose().pose().pose()));
  CycloneProcess late({"late_pose", "rt/amcl_pose"});
  std::istringstream line(late.wait_for_line("pose"));
  std::string word;
  double x = 0.0;
  double y = 0.0;
  ASSERT_TRUE(line >> word >> x >> y);
  EXPECT_NEAR(x, last.x, 1e-3);
  EXPECT_NEAR(y, last.y, 1e-3);
}

TEST_F(CycloneLocalization, HearsWhoSetsThePoseAsRVizDoes) {
  (void)next_pose();
  const Pose2 there{5.5, 3.5, 0.0};
  CycloneProcess rviz({"set_pose", "rt/initialpose", "5.5", "3.5"});
  ASSERT_EQ(rviz.wait_for_line("sent"), "sent");
  Pose2 place = planar(convert::from_message(next_pose().pose().pose()));
  // The pose has come to the process; the component takes it in its turn.
  while (translation_distance(place, there) > 0.5 &&
         next_scan_ < localizer::room().observations.size()) {
    place = planar(convert::from_message(next_pose().pose().pose()));
  }
  EXPECT_LT(translation_distance(place, there), 0.5);
}

TEST_F(CycloneLocalization, ShowsItsLogToWhoComesLate) {
  CycloneProcess tool({"rosout", "rt/rosout"});
  EXPECT_EQ(tool.wait_for_line("log 20 localizer activate"),
            "log 20 localizer activate: is active now");
}

TEST_F(CycloneCostmap, GetsTheMaskOfWhatChangesAndWhatItMeansAsNav2sFiltersDo) {
  start_with_doors({{60, 52}}, "kind: speed, min_speed: 20.0, reach_m: 0.1");
  Collector<nav_msgs::msg::OccupancyGrid> masks(robot_, "/change_mask", "latched");
  while (masks.wait_for(1, std::chrono::milliseconds(200)).empty()) (void)next_pose();
  CycloneProcess info({"filter_info", "rt/change_mask_info"});
  EXPECT_EQ(info.wait_for_line("info"), "info 1 /change_mask 100.000 -0.800 map");
  const nav_msgs::msg::OccupancyGrid sent = masks.wait_for(1).back();
  std::size_t above = 0;
  int greatest = -1;
  for (const std::int8_t value : sent.data()) {
    above += value > 0 ? 1U : 0U;
    greatest = std::max<int>(greatest, value);
  }
  EXPECT_GT(above, 3U);
  CycloneProcess mask({"mask", "rt/change_mask"});
  EXPECT_EQ(mask.wait_for_line("mask"), "mask " + std::to_string(sent.info().width()) + " " +
                                            std::to_string(sent.info().height()) + " " +
                                            std::to_string(above) + " " + std::to_string(greatest));
}

TEST_F(CycloneZones, AreReadByWhoComesLateAsNav2sFiltersDo) {
  Collector<nav_msgs::msg::OccupancyGrid> masks(robot_, "/zones/speed", "latched");
  (void)site_->change_zones(
      [](site::Zones& zones) {
        const MetricPolygon square{{{1.0, 1.0}, {2.0, 1.0}, {2.0, 2.0}, {1.0, 2.0}}, {}};
        site::add(zones,
                  site::zones_of(
                      site::to_feature(
                          {square}, {{"name", "ramp"}, {"kind", "speed"}, {"speed_percent", 30}}),
                      "test"),
                  "test");
      },
      localizer::kAda, "");
  std::size_t limited = 0;
  nav_msgs::msg::OccupancyGrid sent;
  ASSERT_TRUE(comes_true([&] {
    host_->tick();
    const auto all = masks.wait_for(0);
    if (all.empty()) return false;
    sent = all.back();
    limited = static_cast<std::size_t>(std::count(sent.data().begin(), sent.data().end(), 70));
    return limited > 0;
  }));
  CycloneProcess info({"filter_info", "rt/zones/speed_info"});
  EXPECT_EQ(info.wait_for_line("info"), "info 1 /zones/speed 100.000 -1.000 map");
  CycloneProcess mask({"mask", "rt/zones/speed"});
  EXPECT_EQ(mask.wait_for_line("mask"), "mask " + std::to_string(sent.info().width()) + " " +
                                            std::to_string(sent.info().height()) + " " +
                                            std::to_string(limited) + " 70");
}

}  // namespace
}  // namespace strata::test
