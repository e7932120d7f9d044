// SPDX-License-Identifier: Apache-2.0
/// Messages that decode and yet say what cannot be: refused where they become values.
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/convert/geometry_messages.hpp"
#include "components/convert/map_messages.hpp"
#include "components/convert/patch_messages.hpp"
#include "components/convert/scan_messages.hpp"
#include "core/base/error.hpp"

namespace strata::convert {
namespace {

using ::testing::HasSubstr;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Whether the message is refused after `damage`, and was not before.
template <typename Message>
void expect_refused(Message message, const std::function<void(Message&)>& damage,
                    const std::string& problem) {
  ASSERT_NO_THROW((void)from_message(message)) << problem;
  damage(message);
  try {
    (void)from_message(message);
    FAIL() << "taken: " << problem;
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr(problem));
  }
}

strata_msgs::msg::LabeledScan labeled_scan() {
  PosedScan scan;
  scan.scan.angle_increment_rad = 0.1F;
  scan.scan.range_max_m = 10.0F;
  scan.scan.ranges_m = {1.0F, 2.0F, 3.0F};
  scan.static_probability = {0.5F, kNan, 1.0F};
  return to_message(scan, "map", "laser");
}

TEST(LabeledScan, IsRefusedWithoutALabelForEachBeam) {
  using Message = strata_msgs::msg::LabeledScan;
  expect_refused<Message>(
      labeled_scan(), [](auto& m) { m.static_probability().pop_back(); }, "not one a beam");
  expect_refused<Message>(
      labeled_scan(), [](auto& m) { m.static_probability().push_back(0.5F); }, "not one a beam");
  expect_refused<Message>(
      labeled_scan(), [](auto& m) { m.static_probability()[0] = 1e30F; }, "not probabilities");
  expect_refused<Message>(
      labeled_scan(), [](auto& m) { m.static_probability()[0] = -kInfinity; }, "not probabilities");
}

TEST(LabeledScan, IsRefusedWhereItsPoseOrAnglesAreNoNumbers) {
  using Message = strata_msgs::msg::LabeledScan;
  const std::string pose = "its pose is not a number, or further away";
  const std::string mounting = "its mounting is not a number, or further";
  const std::string angles = "its angles or limits";
  expect_refused<Message>(
      labeled_scan(), [](auto& m) { m.pose().map_from_robot().mean().x(1e30); }, pose);
  expect_refused<Message>(
      labeled_scan(), [](auto& m) { m.pose().map_from_robot().mean().theta(kNan); }, pose);
  expect_refused<Message>(
      labeled_scan(), [](auto& m) { m.robot_from_laser().y(kNan); }, mounting);
  expect_refused<Message>(
      labeled_scan(), [](auto& m) { m.robot_from_laser().x(150.0); }, mounting);
  expect_refused<Message>(
      labeled_scan(), [](auto& m) { m.scan().angle_increment(kInfinity); }, angles);
  expect_refused<Message>(
      labeled_scan(), [](auto& m) { m.scan().range_max(kNan); }, angles);
  expect_refused<Message>(
      labeled_scan(),
      [](auto& m) {
        m.scan().ranges().resize(200'000);
        m.static_probability().clear();
      },
      "200000 beams");
}

nav_msgs::msg::OccupancyGrid occupancy() {
  ReflectionGrid grid = make_reflection_grid(0.05, {{-1, -1}, {2, 1}});
  return to_occupancy(grid, Stamp(), "map");
}

TEST(OccupancyGrid, IsRefusedWhereItsSidesDoNotFitItsData) {
  using Message = nav_msgs::msg::OccupancyGrid;
  const std::string fill = "do not fill";
  expect_refused<Message>(
      occupancy(), [](auto& m) { m.info().width(1U << 31U); }, "2^30");
  expect_refused<Message>(
      occupancy(), [](auto& m) { m.info().width(2); }, fill);
  expect_refused<Message>(
      occupancy(), [](auto& m) { m.data().clear(); }, fill);
  expect_refused<Message>(
      occupancy(), [](auto& m) { m.info().resolution(kInfinity); }, "resolution");
  expect_refused<Message>(
      occupancy(), [](auto& m) { m.info().resolution(kNan); }, "resolution");
  expect_refused<Message>(
      occupancy(), [](auto& m) { m.info().origin().orientation().z(kNan); }, "turned");
  expect_refused<Message>(
      occupancy(), [](auto& m) { m.info().origin().position().x(kNan); }, "2^30");
}

TEST(GridMessages, AreRefusedWhereAValueIsNoProbabilityOrCount) {
  using Reflection = strata_msgs::msg::ReflectionGrid;
  using Counts = strata_msgs::msg::CountGrid;
  const Reflection reflection = to_message(make_reflection_grid(0.05, {{0, 0}, {2, 2}}));
  expect_refused<Reflection>(
      reflection, [](auto& m) { m.reflection()[3] = 2.0F; }, "no probability");
  expect_refused<Reflection>(
      reflection, [](auto& m) { m.reflection()[3] = -kInfinity; }, "no probability");
  expect_refused<Reflection>(
      reflection, [](auto& m) { m.resolution(kInfinity); }, "resolution");
  const Counts counts = to_message(Grid<CellCounts>(0.05, {{0, 0}, {2, 2}}));
  expect_refused<Counts>(
      counts, [](auto& m) { m.hits()[0] = kNan; }, "no count");
  expect_refused<Counts>(
      counts, [](auto& m) { m.misses()[0] = -1.0; }, "no count");
}

strata_msgs::msg::PatchMap patch_map() {
  patch::PatchMap map;
  map.base = make_reflection_grid(0.05, {{0, 0}, {10, 10}});
  patch::Submap submap;
  submap.rect = {{2, 2}, {4, 4}};
  submap.contradictory = Grid<std::uint8_t>(0.05, submap.rect);
  submap.configurations.push_back(
      {Grid<CellCounts>(0.05, submap.rect), make_reflection_grid(0.05, submap.rect), 1.0});
  submap.sequences.push_back({0, Stamp(), Stamp(), 1, {1.0}});
  map.submaps.push_back(submap);
  return to_message(map, Stamp(), "map");
}

TEST(PatchMap, IsRefusedWhereItsPartsDoNotFitEachOther) {
  using Message = strata_msgs::msg::PatchMap;
  expect_refused<Message>(
      patch_map(), [](auto& m) { m.submaps()[0].configurations().clear(); }, "no configuration");
  expect_refused<Message>(
      patch_map(), [](auto& m) { m.submaps()[0].id(7); }, "not their places");
  expect_refused<Message>(
      patch_map(), [](auto& m) { m.submaps()[0].sequences()[0].membership().push_back(0.0); },
      "memberships");
  expect_refused<Message>(
      patch_map(), [](auto& m) { m.submaps()[0].configurations()[0].prior(kNan); }, "prior");
  expect_refused<Message>(
      patch_map(),
      [](auto& m) {
        auto& rect = m.submaps()[0].configurations()[0].reflection().rect();
        rect.min_x(rect.min_x() + 1);
        rect.max_x(rect.max_x() + 1);
      },
      "other cells");
  // Two tiny sub-maps at the ends of the world: a table about both would take all memory.
  expect_refused<Message>(
      patch_map(),
      [](auto& m) {
        auto& submap = m.submaps()[0];
        for (auto* rect : {&submap.rect(), &submap.configurations()[0].reflection().rect(),
                           &submap.configurations()[0].counts().rect()}) {
          rect->min_x(rect->min_x() + 1'000'000);
          rect->max_x(rect->max_x() + 1'000'000);
          rect->min_y(rect->min_y() + 1'000'000);
          rect->max_y(rect->max_y() + 1'000'000);
        }
      },
      "far from the base map");
}

TEST(Transform, IsNotStretchedByAQuaternionThatIsNotOfLengthOne) {
  geometry_msgs::msg::Transform message;
  message.rotation().w(10.0);
  EXPECT_DOUBLE_EQ(from_message(message).rotation.norm(), 1.0);
  message.rotation().w(0.0);
  EXPECT_DOUBLE_EQ(from_message(message).rotation.norm(), 1.0) << "unset";
}

}  // namespace
}  // namespace strata::convert
