// SPDX-License-Identifier: Apache-2.0
// One drive, recorded by scanners that are mounted upright, backwards and upside down: with
// tf_static in the bag the maps are the same to a cell.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <vector>

#include "strata_idl/tf2_msgs.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/convert/cdr.hpp"
#include "components/convert/geometry_messages.hpp"
#include "components/convert/scan_messages.hpp"
#include "components/log/bag.hpp"
#include "components/log/log_reader.hpp"
#include "tests/core/slam/ring_world.hpp"
#include "tests/support/test_data.hpp"

namespace strata::slam {
namespace {

constexpr int kBeams = 180;         // all of them are matched
constexpr double kForward_m = 0.2;  // the scanner ahead of the base

enum class Mounted { kUpright, kBackwards, kUpsideDown, kBackwardsAndUpsideDown };

bool is_backwards(Mounted mounted) {
  return mounted == Mounted::kBackwards || mounted == Mounted::kBackwardsAndUpsideDown;
}
bool hangs(Mounted mounted) {
  return mounted == Mounted::kUpsideDown || mounted == Mounted::kBackwardsAndUpsideDown;
}

/// What a scanner with a full circle reads: half a circle on when it looks backwards, and the other
/// way round when it hangs.
Scan as_mounted(Scan scan, Mounted mounted) {
  if (is_backwards(mounted)) {
    std::rotate(scan.ranges_m.begin(), scan.ranges_m.begin() + kBeams / 2, scan.ranges_m.end());
  }
  if (hangs(mounted)) std::reverse(scan.ranges_m.begin(), scan.ranges_m.end());
  return scan;
}

geometry_msgs::msg::TransformStamped mounting(Mounted mounted) {
  geometry_msgs::msg::TransformStamped result =
      convert::to_transform_stamped(Stamp{}, {kForward_m, 0.0, 0.0}, "base_link", "laser");
  // About z by half a turn, about x, or one after the other: about y.
  const bool back = is_backwards(mounted);
  const bool over = hangs(mounted);
  result.transform().rotation().x(over && !back ? 1.0 : 0.0);
  result.transform().rotation().y(over && back ? 1.0 : 0.0);
  result.transform().rotation().z(back && !over ? 1.0 : 0.0);
  result.transform().rotation().w(back || over ? 0.0 : 1.0);
  return result;
}

void write_drive(const std::filesystem::path& folder, Mounted mounted) {
  const std::vector<Pose2> path = test::drive_round(0.1, 22.0);
  std::vector<Observation> log = test::record(test::ring(), path, 0, 41);
  log::BagWriter bag(folder, log::BagStorage::kMcap);
  const auto tf = bag.add_topic({"/tf_static", "tf2_msgs/msg/TFMessage", "cdr", ""});
  const auto odometry = bag.add_topic({"/odom", "nav_msgs/msg/Odometry", "cdr", ""});
  const auto scans = bag.add_topic({"/scan", "sensor_msgs/msg/LaserScan", "cdr", ""});
  tf2_msgs::msg::TFMessage fixed;
  fixed.transforms().push_back(mounting(mounted));
  bag.write(tf, Stamp{}, convert::to_cdr(fixed));
  for (std::size_t i = 0; i < log.size(); ++i) {
    const Stamp stamp = log[i].scan.stamp;
    const Pose2& pose = log[i].odom_from_robot;
    nav_msgs::msg::Odometry message;
    message.header().stamp(convert::to_message(stamp));
    message.header().frame_id("odom");
    message.child_frame_id("base_link");
    message.pose().pose().position().x(pose.x);
    message.pose().pose().position().y(pose.y);
    message.pose().pose().orientation().z(std::sin(0.5 * pose.theta));
    message.pose().pose().orientation().w(std::cos(0.5 * pose.theta));
    bag.write(odometry, stamp, convert::to_cdr(message));
    const Scan scan = test::scan_of(test::ring(), path[i] * Pose2{kForward_m, 0.0, 0.0},
                                    stamp.seconds(), 0.01, 41, kBeams, 2.0 * std::numbers::pi);
    bag.write(scans, stamp,
              convert::to_cdr(convert::to_message(as_mounted(scan, mounted), "laser")));
  }
  bag.close();
}

SlamResult learn(Mounted mounted) {
  const strata::test::TemporaryDirectory folder;
  write_drive(folder.path() / "bag", mounted);
  return test::run_slam(log::read_observations(folder.path() / "bag"));
}

/// Of the occupied cells of one map the share that is occupied in the other too, there or beside.
double share_found(const ReflectionGrid& map, const ReflectionGrid& other) {
  std::size_t occupied = 0;
  std::size_t found = 0;
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (!is_occupied(map.values()[i])) continue;
    ++occupied;
    bool near = false;
    for (int k = 0; k < 9; ++k) {
      const Cell cell = map.cell(i);
      near = near || is_occupied(other.get({cell.x + k % 3 - 1, cell.y + k / 3 - 1}));
    }
    found += near ? 1 : 0;
  }
  EXPECT_GT(occupied, 500U);
  return static_cast<double>(found) / static_cast<double>(occupied);
}

class Mountings : public ::testing::TestWithParam<Mounted> {};

TEST_P(Mountings, GiveTheMapOfTheUprightScanner) {
  static const SlamResult upright = learn(Mounted::kUpright);
  EXPECT_THAT(upright.warnings, ::testing::IsEmpty());
  const SlamResult result = learn(GetParam());
  EXPECT_THAT(result.warnings, ::testing::IsEmpty());
  ASSERT_EQ(result.scans.size(), upright.scans.size());
  EXPECT_LT(test::worst_error(result, test::drive_round(0.1, 22.0), 0), 0.04);
  EXPECT_GT(share_found(upright.filtered, result.filtered), 0.98);
  EXPECT_GT(share_found(result.filtered, upright.filtered), 0.98);
}

INSTANTIATE_TEST_SUITE_P(OnTheirHeads, Mountings,
                         ::testing::Values(Mounted::kBackwards, Mounted::kUpsideDown,
                                           Mounted::kBackwardsAndUpsideDown),
                         [](const auto& mounted) {
                           return std::string(is_backwards(mounted.param) ? "Backwards" : "") +
                                  (hangs(mounted.param) ? "UpsideDown" : "");
                         });

}  // namespace
}  // namespace strata::slam
