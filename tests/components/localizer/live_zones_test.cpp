// SPDX-License-Identifier: Apache-2.0
/// What a robot that drives tells nav2 of the zones of its site.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/components/localizer/site_fixture.hpp"
#include "tests/support/nav2_costmap.hpp"

namespace strata::localizer {
namespace {

using nav2_msgs::msg::CostmapFilterInfo;
using nav_msgs::msg::OccupancyGrid;
using testing::HasSubstr;

/// A square of 1 m by its lower left corner.
site::Zones square(double x_m, double y_m, site::Zones::Document properties) {
  const MetricPolygon polygon{
      {{x_m, y_m}, {x_m + 1.0, y_m}, {x_m + 1.0, y_m + 1.0}, {x_m, y_m + 1.0}}, {}};
  return site::zones_of(site::to_feature({polygon}, std::move(properties)), "test");
}

/// What a grid says at a point.
int value_at(const OccupancyGrid& grid, double x_m, double y_m) {
  const auto cell = [&](double at_m, double origin_m) {
    return static_cast<std::size_t>(
        std::floor((at_m - origin_m) / static_cast<double>(grid.info().resolution())));
  };
  const std::size_t x = cell(x_m, grid.info().origin().position().x());
  const std::size_t y = cell(y_m, grid.info().origin().position().y());
  return x < grid.info().width() && y < grid.info().height()
             ? grid.data()[y * grid.info().width() + x]
             : -2;
}

class LiveZones : public LiveSite {
 protected:
  void add(const site::Zones& more) {
    (void)site_->change_zones([&](site::Zones& zones) { site::add(zones, more, "test"); }, kAda,
                              "");
  }
  /// Whether the last mask comes to say so.
  [[nodiscard]] bool says(test::Collector<OccupancyGrid>& masks, double x_m, double y_m,
                          int value) {
    return test::comes_true([&] {
      host_->tick();
      const auto all = masks.wait_for(0);
      return !all.empty() && value_at(all.back(), x_m, y_m) == value;
    });
  }
  test::Collector<OccupancyGrid> keepout_{robot_, "/zones/keepout", "latched"};
  test::Collector<OccupancyGrid> speed_{robot_, "/zones/speed", "latched"};
  test::Collector<CostmapFilterInfo> speed_info_{robot_, "/zones/speed_info", "latched"};
};

TEST_F(LiveZones, AreThereAgainWhenSomebodyChangesThemWithoutARestart) {
  EXPECT_TRUE(says(keepout_, 1.5, 1.5, -1)) << "also where nobody drew any";
  EXPECT_TRUE(says(speed_, 1.5, 1.5, 0));
  add(square(1.0, 1.0, {{"name", "dock"}, {"kind", "keepout"}}));
  EXPECT_TRUE(says(keepout_, 1.5, 1.5, 100));
  EXPECT_EQ(value_at(keepout_.wait_for(1).back(), 2.5, 1.5), -1);
  add(square(2.0, 1.0, {{"name", "ramp"}, {"kind", "speed"}, {"speed_percent", 30}}));
  EXPECT_TRUE(says(speed_, 2.5, 1.5, 70));
  EXPECT_EQ(keepout_.wait_for(1).size(), 2U) << "only what changed is sent again";
  EXPECT_EQ(speed_info_.wait_for(1).size(), 1U) << "with each nav2 would subscribe anew";
  const CostmapFilterInfo info = speed_info_.wait_for(1).back();
  EXPECT_EQ(info.type(), 1);
  EXPECT_EQ(info.filter_mask_topic(), "/zones/speed");
  EXPECT_EQ(test::nav2::speed_limit(70, info.base(), info.multiplier()), 30.0);
  (void)site_->change_zones([](site::Zones& zones) { site::remove(zones, "dock", "test"); }, kAda,
                            "");
  EXPECT_TRUE(says(keepout_, 1.5, 1.5, -1));
  EXPECT_LT(error_of(next_pose()), 0.2) << "meanwhile the robot drives";
  EXPECT_TRUE(host_->take_errors().empty());
}

TEST_F(LiveZones, AreToldToLateJoinersAsTheyAreNow) {
  add(square(1.0, 1.0, {{"name", "dock"}, {"kind", "keepout"}, {"cost_percent", 60}}));
  ASSERT_TRUE(says(keepout_, 1.5, 1.5, 60));
  test::Collector<OccupancyGrid> late(robot_, "/zones/keepout", "latched");
  test::Collector<CostmapFilterInfo> late_info(robot_, "/zones/keepout_info", "latched");
  ASSERT_EQ(late.wait_for(1).size(), 1U);
  EXPECT_EQ(late.wait_for(1)[0], keepout_.wait_for(1).back());
  ASSERT_EQ(late_info.wait_for(1).size(), 1U);
  EXPECT_EQ(late_info.wait_for(1)[0].type(), 0);
  // Beyond the map, where nobody has been: the mask reaches there.
  add(square(-30.0, -30.0, {{"name", "stairs"}, {"kind", "keepout"}}));
  EXPECT_TRUE(says(keepout_, -29.5, -29.5, 100));
  EXPECT_EQ(value_at(keepout_.wait_for(1).back(), 1.5, 1.5), 60);
}

TEST_F(LiveZones, AreStampedWithTheTimeOfTheNode) {
  bus::Writer<rosgraph_msgs::msg::Clock> clock(robot_, "/clock", bus::qos_profile("clock"));
  std::string parameters = parameters_in(site_->folder());
  start(parameters.insert(1, "use_sim_time: true, "));
  rosgraph_msgs::msg::Clock now;
  now.clock().sec(4242);
  ASSERT_TRUE(test::comes_true([&] {
    clock.publish(now);
    host_->tick();
    const auto all = diagnostics_.wait_for(0);
    return !all.empty() && all.back().header().stamp() == now.clock();
  }));
  add(square(1.0, 1.0, {{"name", "dock"}, {"kind", "keepout"}}));
  ASSERT_TRUE(says(keepout_, 1.5, 1.5, 100));
  EXPECT_EQ(keepout_.wait_for(1).back().header().stamp(), now.clock());
}

TEST_F(LiveZones, ThatDoNothingAreToldOf) {
  const MetricPolygon tape{{{1.0, 1.01}, {2.0, 1.01}, {2.0, 1.02}, {1.0, 1.02}}, {}};
  add(site::zones_of(site::to_feature({tape}, {{"name", "tape"}, {"kind", "keepout"}}), "test"));
  EXPECT_TRUE(test::comes_true([&] {
    host_->tick();
    const auto all = diagnostics_.wait_for(0);
    return !all.empty() && all.back().status().front().message().find(
                               "these zones do nothing: 'tape'") != std::string::npos;
  }));
}

TEST_F(LiveZones, OfOneKindThatMakeNoMaskLeaveTheOthers) {
  auto slow = square(3.0, 1.0, {{"name", "slow"}, {"kind", "speed"}, {"speed_m_s", 0.02}});
  site::add(slow, square(2.0, 1.0, {{"name", "fast"}, {"kind", "speed"}, {"speed_m_s", 5.0}}), "");
  site::add(slow, square(9e3, 9e3, {{"name", "far"}, {"kind", "speed"}, {"speed_percent", 9}}), "");
  site::add(slow, square(1.0, 1.0, {{"name", "stairs"}, {"kind", "keepout"}}), "");
  add(slow);
  EXPECT_TRUE(says(keepout_, 1.5, 1.5, 100));
  std::string said;
  for (const char* fault :
       {"zones of speed_m_s are not used", "zone 'slow'", "zones of speed are"}) {
    EXPECT_TRUE(test::comes_true([&] {
      host_->tick();
      const auto all = diagnostics_.wait_for(0);
      if (!all.empty()) said = all.back().status().front().message();
      return said.find(fault) != std::string::npos;
    })) << said;
  }
}

TEST_F(LiveZones, ThatCannotBeReadLeaveTheMasksAndAreToldOf) {
  add(square(1.0, 1.0, {{"name", "dock"}, {"kind", "keepout"}}));
  ASSERT_TRUE(says(keepout_, 1.5, 1.5, 100));
  const std::size_t sent = keepout_.wait_for(1).size();
  const std::string good = test::bytes_of(site_->zones_file());
  std::ofstream(site_->zones_file()) << R"({"type": "FeatureCollection", "features": [{}]})";
  std::string said;
  const auto message_has = [&](const std::string& text) {
    return test::comes_true([&] {
      host_->tick();
      const auto all = diagnostics_.wait_for(0);
      if (all.empty()) return false;
      said = all.back().status().front().message();
      return said.find(text) != std::string::npos;
    });
  };
  EXPECT_TRUE(message_has("feature 1")) << said;
  EXPECT_EQ(keepout_.wait_for(1).size(), sent);
  EXPECT_LT(error_of(next_pose()), 0.2);
  std::ofstream(site_->zones_file()) << good;
  EXPECT_TRUE(test::comes_true([&] {
    host_->tick();
    return diagnostics_.wait_for(0).back().status().front().message().find("feature 1") ==
           std::string::npos;
  }));
}

}  // namespace
}  // namespace strata::localizer
