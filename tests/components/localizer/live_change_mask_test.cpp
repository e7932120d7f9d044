// SPDX-License-Identifier: Apache-2.0
/// What a robot that drives tells nav2 of places that often change.
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/convert/map_messages.hpp"
#include "components/convert/patch_messages.hpp"
#include "components/runtime/diagnostics.hpp"
#include "tests/components/localizer/door_fixture.hpp"
#include "tests/support/comes_true.hpp"
#include "tests/support/nav2_costmap.hpp"

namespace strata::localizer {
namespace {

using Grids = std::vector<nav_msgs::msg::OccupancyGrid>;

/// In the middle of the room, where the robot sees it; the other is elsewhere.
const Cell kDoorOfOffice{60, 52};
const Cell kOther{40, 60};

std::int8_t value_at(const nav_msgs::msg::OccupancyGrid& grid, const Cell& cell) {
  const double resolution_m = static_cast<double>(grid.info().resolution());
  const int x =
      cell.x - static_cast<int>(std::lround(grid.info().origin().position().x() / resolution_m));
  const int y =
      cell.y - static_cast<int>(std::lround(grid.info().origin().position().y() / resolution_m));
  return grid
      .data()[static_cast<std::size_t>(y) * grid.info().width() + static_cast<std::size_t>(x)];
}

class LiveChangeMask : public LiveDoor {
 protected:
  /// Drives on until one more mask has come, and gives all of them.
  [[nodiscard]] Grids masks_after(std::size_t count) {
    Grids masks = masks_.wait_for(0);
    while (masks.size() <= count && next_scan_ < room().observations.size()) {
      (void)next_pose();
      masks = masks_.wait_for(count + 1, std::chrono::milliseconds(200));
    }
    return masks;
  }

  test::Collector<nav_msgs::msg::OccupancyGrid> masks_{robot_, "/change_mask", "latched"};
  test::Collector<nav_msgs::msg::OccupancyGrid> maps_{robot_, "/map_current", "latched"};
  test::Collector<nav2_msgs::msg::CostmapFilterInfo> infos_{robot_, "/change_mask_info", "latched"};
  test::Collector<strata_msgs::msg::SubmapStates> states_{robot_, "/submap_states", "latched"};
};

TEST_F(LiveChangeMask, HasTheProbabilityThatTheDoorIsNotAsItIsBelievedOnTheCellsOfTheMap) {
  start_with_doors({kDoorOfOffice}, "kind: penalty, horizon_s: 300.0, reach_m: 0.1");
  const auto masks = masks_after(0);
  ASSERT_FALSE(masks.empty());
  const auto& mask = masks.front();
  const auto maps = maps_.wait_for(1);
  ASSERT_FALSE(maps.empty());
  EXPECT_EQ(maps.front().info(), mask.info()) << "KeepoutFilter takes them for the same cells";
  EXPECT_EQ(maps.front().header().stamp(), mask.header().stamp());
  std::optional<double> open;
  (void)test::comes_true([&] {
    for (const auto& message : states_.wait_for(1)) {
      if (message.header().stamp() != mask.header().stamp()) continue;
      open = message.states().at(0).probability().at(0);
    }
    return open.has_value();
  });
  ASSERT_TRUE(open);
  const double held = std::max(*open, 1.0 - *open);
  const double other = *open > 0.5 ? kUsuallyShut : 1.0 - kUsuallyShut;
  const double changed = 1.0 - held * std::exp(-kRate_per_s * other * 300.0);
  EXPECT_GT(changed, 0.1);
  EXPECT_NEAR(value_at(mask, kDoorOfOffice), 99.0 * changed, 1.0);
  EXPECT_NEAR(value_at(maps.front(), kDoorOfOffice), 100.0 * (1.0 - *open), 1.0);
  EXPECT_EQ(value_at(mask, {kDoorOfOffice.x, kDoorOfOffice.y + 2}), value_at(mask, kDoorOfOffice))
      << "within 0.1 m";
  EXPECT_EQ(value_at(mask, {kDoorOfOffice.x, kDoorOfOffice.y + 3}), -1)
      << "nothing to add to the map's cost";
  EXPECT_EQ(test::nav2::kept_out_cost(value_at(mask, kDoorOfOffice), 0),
            std::lround(value_at(mask, kDoorOfOffice) * 2.54));
  const auto infos = infos_.wait_for(1);
  ASSERT_EQ(infos.size(), 1U);
  EXPECT_EQ(infos[0].type(), 0);
  EXPECT_EQ(infos[0].filter_mask_topic(), "/change_mask");
  EXPECT_TRUE(host_->take_errors().empty());
}

TEST_F(LiveChangeMask, IsThereForLateJoinersAndFollowsMapsThatAreExchanged) {
  start_with_doors({kDoorOfOffice}, "kind: speed, reach_m: 0.0");
  bus::Writer<strata_msgs::msg::PatchMap> learner(robot_, "/patch_map",
                                                  bus::qos_profile("latched"));
  auto masks = masks_after(0);
  ASSERT_FALSE(masks.empty());
  EXPECT_GT(value_at(masks.back(), kDoorOfOffice), 0);
  EXPECT_EQ(value_at(masks.back(), kOther), 0) << "no limit, where SpeedFilter takes no unknown";
  // Until the new map's mask has come: one that shows the other door.
  const auto shows = [&](const Cell& cell) {
    while (value_at(masks.back(), cell) <= 0) {
      const std::size_t before = masks.size();
      masks = masks_after(before);
      if (masks.size() == before) return false;
    }
    return true;
  };
  learner.publish(convert::to_message(with_doors({kOther}), Stamp(), "map"));
  ASSERT_TRUE(shows(kOther));
  EXPECT_EQ(value_at(masks.back(), kDoorOfOffice), 0) << "of the map before";
  test::Collector<nav_msgs::msg::OccupancyGrid> late(robot_, "/change_mask", "latched");
  test::Collector<nav2_msgs::msg::CostmapFilterInfo> late_info(robot_, "/change_mask_info",
                                                               "latched");
  ASSERT_EQ(late.wait_for(1).size(), 1U);
  EXPECT_EQ(late.wait_for(1)[0], masks_.wait_for(1).back());
  ASSERT_EQ(late_info.wait_for(1).size(), 1U);
  EXPECT_EQ(late_info.wait_for(1)[0].type(), 1);
  EXPECT_EQ(infos_.wait_for(1).size(), 1U) << "with each nav2 would subscribe anew";
  // A map in which nothing changes takes back what was said.
  learner.publish(convert::to_message(with_doors({}), Stamp(), "map"));
  const auto is_quiet = [&] {
    const auto& data = masks.back().data();
    return std::all_of(data.begin(), data.end(), [](std::int8_t value) { return value == 0; });
  };
  for (std::size_t before = 0; !is_quiet() && before != masks.size();) {
    before = masks.size();
    masks = masks_after(before);
  }
  EXPECT_TRUE(is_quiet());
  EXPECT_TRUE(host_->take_errors().empty());
}

TEST_F(LiveChangeMask, ComesAgainWhenTheDoorIsFoundOtherwise) {
  // The map says that it is mostly shut, and as if nobody had seen it for long.
  start_with_doors({kDoorOfOffice}, "kind: penalty");
  const auto masks = masks_after(1);
  const auto maps = maps_.wait_for(2);
  ASSERT_GE(masks.size(), 2U);
  ASSERT_GE(maps.size(), 2U);
  // It is open, and with each beam through it that is surer.
  EXPECT_LT(value_at(maps.back(), kDoorOfOffice), value_at(maps.front(), kDoorOfOffice));
  EXPECT_LT(value_at(masks.back(), kDoorOfOffice), value_at(masks.front(), kDoorOfOffice));
}

TEST_F(LiveChangeMask, IsNotSentByAModelWithoutSubmapsWhichSaysSo) {
  test::Collector<rcl_interfaces::msg::Log> log(robot_, "/rosout", "rosout");
  test::Collector<diagnostic_msgs::msg::DiagnosticArray> diagnostics(robot_, "/diagnostics",
                                                                     "default");
  std::string text = parameters_of("filtered", false);
  text.pop_back();
  start(text + ", change_mask: {kind: penalty}}");
  (void)next_pose();
  (void)next_pose();
  ASSERT_EQ(maps_.wait_for(1).size(), 1U);
  EXPECT_TRUE(test::comes_true([&] {
    for (const auto& line : log.wait_for(0)) {
      if (line.msg().find("the model filtered has no sub-maps") != std::string::npos) return true;
    }
    return false;
  }));
  std::string said;
  EXPECT_TRUE(test::comes_true([&] {
    host_->tick();
    for (const auto& message : diagnostics.wait_for(0)) {
      for (const auto& one : message.status()) {
        const std::string value(runtime::value_of(one, "change mask"));
        if (!value.empty()) said = value;
      }
    }
    return !said.empty();
  }));
  EXPECT_THAT(said, ::testing::HasSubstr("filtered"));
  EXPECT_TRUE(masks_.wait_for(1, std::chrono::milliseconds(300)).empty());
  EXPECT_TRUE(infos_.wait_for(1, std::chrono::milliseconds(1)).empty());
}

}  // namespace
}  // namespace strata::localizer
