// SPDX-License-Identifier: Apache-2.0
#include "components/convert/cdr_check.hpp"

#include <cstdint>
#include <vector>

#include "strata_idl/diagnostic_msgs.h"
#include "strata_idl/nav2_msgs.h"
#include "strata_idl/nav_msgs.h"
#include "strata_idl/octomap_msgs.h"
#include "strata_idl/rmw_dds_common.h"
#include "strata_idl/std_msgs.h"
#include "strata_idl/strata_msgs.h"
#include "strata_idl/strata_msgs_site.h"
#include "strata_idl/tf2_msgs.h"
#include <gtest/gtest.h>

#include "components/convert/cdr.hpp"
#include "core/base/error.hpp"

namespace strata::convert {
namespace {

template <typename Message>
class EveryMessage : public ::testing::Test {};

strata_msgs::msg::PatchMap partly_filled_patch_map() {
  strata_msgs::msg::PatchMap map;
  map.header().frame_id("map");
  map.base().reflection({0.5F});
  map.submaps().resize(3);
  map.submaps()[1].contradictory({1, 0, 1});
  map.submaps()[1].configurations().resize(2);
  map.submaps()[1].configurations()[1].counts().hits({1.0, 2.0});
  map.submaps()[2].sequences().resize(1);
  return map;
}

using Messages = ::testing::Types<
    sensor_msgs::msg::LaserScan, nav_msgs::msg::Odometry, nav_msgs::msg::OccupancyGrid,
    tf2_msgs::msg::TFMessage, geometry_msgs::msg::PoseWithCovarianceStamped,
    nav2_msgs::msg::ParticleCloud, nav2_msgs::msg::CostmapFilterInfo, octomap_msgs::msg::Octomap,
    diagnostic_msgs::msg::DiagnosticArray, strata_msgs::msg::LabeledScan,
    strata_msgs::msg::Trajectory, strata_msgs::msg::ReflectionGrid, strata_msgs::msg::NodeMap,
    strata_msgs::msg::SubmapStates, strata_msgs::msg::LocalizationHealth, strata_msgs::msg::Step,
    strata_msgs::msg::Ack, strata_msgs::msg::SiteVersions, strata_msgs::msg::SiteLevel,
    std_msgs::msg::Float64>;
TYPED_TEST_SUITE(EveryMessage, Messages);

TYPED_TEST(EveryMessage, HasTheLayoutThatItsIdlSays) {
  const std::vector<std::uint8_t> bytes = to_cdr(TypeParam());
  const MessageLayout* layout = message_layout(message_type<TypeParam>());
  ASSERT_NE(layout, nullptr) << message_type<TypeParam>();
  EXPECT_EQ(fit(*layout, bytes), LayoutFit::kExact);
  EXPECT_EQ(fit(*layout, std::span(bytes).first(bytes.size() - 4)), LayoutFit::kTooShort);
  std::vector<std::uint8_t> longer = bytes;
  longer.resize(bytes.size() + 8);
  EXPECT_EQ(fit(*layout, longer), LayoutFit::kMoreBehind);
}

TEST(CdrCheck, NamesTheTypeOfAGeneratedClass) {
  EXPECT_EQ(message_type<strata_msgs::msg::PatchMap>(), "strata_msgs/msg/PatchMap");
}

TEST(CdrCheck, WalksOverNestedSequences) {
  const std::vector<std::uint8_t> bytes = to_cdr(partly_filled_patch_map());
  EXPECT_EQ(fit(*message_layout("strata_msgs/msg/PatchMap"), bytes), LayoutFit::kExact);
}

/// Where a length stood, four bytes of ones ask for the memory of the whole machine: no place of a
/// message may get it. Other places hold numbers, where the message stays readable.
TEST(CdrCheck, NoLengthInAMessageIsBelieved) {
  const std::vector<std::uint8_t> bytes = to_cdr(partly_filled_patch_map());
  std::size_t refused = 0;
  for (std::size_t at = 4; at + 4 <= bytes.size(); at += 4) {
    std::vector<std::uint8_t> damaged = bytes;
    for (std::size_t i = 0; i < 4; ++i) damaged[at + i] = 0xFF;
    try {
      (void)from_cdr<strata_msgs::msg::PatchMap>(damaged, "test");
    } catch (const InputError&) {
      ++refused;
    }
  }
  // 3 of the map, 3 of each of 3 sub-maps, 3 of each of 2 configurations, 1 of the sequence.
  EXPECT_EQ(refused, 19U);
}

}  // namespace
}  // namespace strata::convert
