// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "components/runtime/pose_watch.hpp"
#include "components/runtime/scan_queue.hpp"
#include "components/runtime/stamp_watch.hpp"

namespace strata::runtime {
namespace {

Stamp at_s(double s) { return Stamp::from_seconds(s); }

TEST(StampWatch, DoubtsOneStampFarAheadAndGoesOnWithThoseThatFollow) {
  StampWatch watch;
  EXPECT_TRUE(watch.believes(at_s(100.0)));
  EXPECT_FALSE(watch.believes(at_s(5000.0)));
  EXPECT_TRUE(watch.believes(at_s(100.1)));
  EXPECT_FALSE(watch.believes(at_s(5000.0))) << "it has to follow at once";
}

TEST(StampWatch, BelievesTheSecondAfterAGap) {
  StampWatch watch;
  EXPECT_TRUE(watch.believes(at_s(100.0)));
  EXPECT_TRUE(watch.believes(at_s(160.0)));
  EXPECT_FALSE(watch.believes(at_s(1000.0)));
  EXPECT_TRUE(watch.believes(at_s(1000.1)));
  EXPECT_TRUE(watch.believes(at_s(1000.2)));
}

TEST(StampWatch, BelievesAClockThatIsSetBack) {
  StampWatch watch;
  EXPECT_TRUE(watch.believes(at_s(1000.0)));
  EXPECT_TRUE(watch.believes(at_s(10.0)));
  EXPECT_TRUE(watch.believes(at_s(10.1)));
}

// The watch remembered a suspect that the queue had dropped.
TEST(ScanQueue, GoesOnWhereALateScanComesBetweenTwoThatAreFarTooOld) {
  ScanQueue queue(true);
  const auto add = [&](double stamp_s) {
    log::SensedScan sensed;
    sensed.frame = "laser";
    sensed.scan.stamp = at_s(stamp_s);
    sensed.scan.ranges_m = {1.0F};
    queue.add(0, sensed, [](Stamp) { FAIL() << "the clock was not set back"; });
  };
  for (const double stamp_s : {100.0, 10.0, 99.5, 10.1, 100.1}) add(stamp_s);
  EXPECT_EQ(queue.size(), 3U);
  EXPECT_EQ(queue.front().stamp(), at_s(99.5));
  EXPECT_EQ(queue.late(), 2U);
}

TEST(PoseWatch, DoubtsOnePoseFarAwayAndGoesOnWithThoseThatFollow) {
  PoseWatch watch;
  watch.require({1.0, 2.0, 0.0}, "/scan");
  EXPECT_THROW(watch.require({1e4, 2.0, 0.0}, "/scan"), InputError);
  EXPECT_NO_THROW(watch.require({1.1, 2.0, 0.0}, "/scan"));
  EXPECT_THROW(watch.require({1e4, 2.0, 0.0}, "/scan"), InputError);
}

TEST(PoseWatch, BelievesTheSecondWhereARobotWasMovedByHand) {
  PoseWatch watch;
  watch.require({1.0, 2.0, 0.0}, "/scan");
  EXPECT_NO_THROW(watch.require({90.0, 2.0, 0.0}, "/scan"));
  EXPECT_THROW(watch.require({500.0, 2.0, 0.0}, "/scan"), InputError);
  EXPECT_NO_THROW(watch.require({500.2, 2.0, 0.0}, "/scan"));
  EXPECT_NO_THROW(watch.require({500.4, 2.0, 0.0}, "/scan"));
}

}  // namespace
}  // namespace strata::runtime
