// SPDX-License-Identifier: Apache-2.0
/// How long a robot that has just started waits for what it has not heard yet.
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/runtime/sensor_input.hpp"
#include "tests/components/sensor_input/recorded_robot.hpp"

namespace strata::runtime {
namespace {

using test::link;
using test::odometry;
using test::scan;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

// At a start the reader of odometry may meet its writer later than the scans' reader theirs.
TEST(FirstScans, OfAFastScannerInABurstWaitForTheirOdometry) {
  SensorInput input({}, true);
  input.add(link(0.0, "base_link", "laser", {}));
  for (int i = 0; i < 40; ++i) {
    input.add(scan(1.0 + 0.025 * i));
    EXPECT_THAT(input.take(), IsEmpty()) << i;
  }
  for (int i = 0; i <= 30; ++i) input.add(odometry(0.9 + 0.05 * i, {0.9 + 0.05 * i, 0.0, 0.0}));
  const auto taken = input.take();
  ASSERT_THAT(taken, SizeIs(40));
  for (const Observation& observation : taken) {
    EXPECT_TRUE(observation.has_odometry);
    EXPECT_NEAR(observation.odom_from_robot.x, observation.scan.stamp.seconds(), 1e-9);
  }
  EXPECT_THAT(input.take_warnings(), IsEmpty());
}

TEST(FirstScans, OfAFastScannerInABurstWaitForItsMounting) {
  SensorInput input({}, true);
  for (int i = 0; i <= 40; ++i) input.add(odometry(0.9 + 0.05 * i, {}));
  for (int i = 0; i < 40; ++i) input.add(scan(1.0 + 0.025 * i));
  EXPECT_THAT(input.take(), IsEmpty());
  input.add(link(0.0, "base_link", "laser", {0.3, 0.0, 0.0}));
  const auto taken = input.take();
  ASSERT_THAT(taken, SizeIs(40));
  EXPECT_EQ(taken.front().scan.robot_from_laser, (Pose2{0.3, 0.0, 0.0}));
}

TEST(FirstScans, WaitForWhatNobodyPublishesSoManySecondsOfStampsAndSoManyScans) {
  SensorInputConfig config;
  config.first_wait_s = 3.0;
  for (const double period_s : {0.1, 0.025}) {
    SensorInput input(config, true);
    input.add(link(0.0, "base_link", "laser", {}));
    int waiting = 0;
    for (; input.take().empty(); ++waiting) input.add(scan(1.0 + period_s * waiting));
    EXPECT_EQ(waiting, static_cast<int>(std::lround(3.0 / period_s)) + 1);
    EXPECT_THAT(input.take_warnings(), ElementsAre(HasSubstr("no odometry comes")));
  }
  SensorInput slow(config, true);
  slow.add(link(0.0, "base_link", "laser", {}));
  for (int i = 0; i < 20; ++i) slow.add(scan(1.0 + i));
  EXPECT_THAT(slow.take(), IsEmpty());
  slow.add(scan(21.0));
  EXPECT_THAT(slow.take(), SizeIs(21));
}

TEST(FirstScans, WhoseStampsStandStillDoNotFillTheMemory) {
  SensorInput input({}, true);
  for (int i = 0; i < 200; ++i) input.add(scan(1.0));
  EXPECT_THAT(input.take(), IsEmpty());
  input.add(scan(1.0));
  EXPECT_THAT(input.take(), SizeIs(201));
}

}  // namespace
}  // namespace strata::runtime
