// SPDX-License-Identifier: Apache-2.0
#include "components/maps/node_map_message.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/error.hpp"

namespace strata::maps {
namespace {

strata_msgs::msg::NodeMap two_nodes(double radius_m, double x_m) {
  strata_msgs::msg::NodeMap message;
  message.radius(radius_m);
  for (const double x : {0.0, x_m}) {
    strata_msgs::msg::NodeLevel level;
    level.ranges(std::vector<float>(12, 3.0F));
    strata_msgs::msg::MemoryNode node;
    node.pose().x(x);
    node.levels().push_back(level);
    message.nodes().push_back(node);
  }
  return message;
}

TEST(NodeMapMessage, IsRefusedWhenATableOfItsNodesWouldTakeAllMemory) {
  EXPECT_EQ(from_message(two_nodes(8.0, 500.0), {})->nodes().size(), 2U);
  const double inf = std::numeric_limits<double>::infinity();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double x_m : {3e5, -1e300, inf, nan}) {
    EXPECT_THROW((void)from_message(two_nodes(8.0, x_m), {}), InputError) << x_m;
  }
  for (const double radius_m : {1e5, inf, nan, 0.0, -1.0}) {
    EXPECT_THROW((void)from_message(two_nodes(radius_m, 1.0), {}), InputError) << radius_m;
  }
}

TEST(NodeMapMessage, KeepsFreeWaysWhoseEndNobodySaw) {
  auto message = two_nodes(8.0, 20.0);
  auto& ranges = message.nodes()[0].levels()[0].ranges();
  ranges[0] = -5.0F;
  ranges[1] = -5.0F;
  const auto map = from_message(message, {});
  EXPECT_EQ(map->nodes()[0].levels[0]->scan.range_m[0], -5.0F);
  EXPECT_EQ(map->nodes()[0].levels[0]->outline.edge(0), memory::NodeOutline::Edge::kHidden);
  EXPECT_TRUE(std::isnan(map->expected_scan(0, 0).ranges_m[0]));
  ranges[1] = -8.5F;
  EXPECT_THROW((void)from_message(message, {}), InputError);
}

}  // namespace
}  // namespace strata::maps
