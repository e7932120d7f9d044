// SPDX-License-Identifier: Apache-2.0
#include "core/scan/spacing.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "core/geometry/angle.hpp"
#include "core/random/stream.hpp"

namespace strata {
namespace {

/// Drives, stands, turns on the spot and drives on, at 10 Hz.
std::vector<PosedScan> drive() {
  std::vector<PosedScan> scans(1000);
  RandomStream random(1, StreamId::kTest);
  Pose2 pose;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    scans[i].scan.stamp = Stamp::from_seconds(100.0 + 0.1 * static_cast<double>(i));
    scans[i].map_from_robot = pose;
    if (i < 300) pose.x += 0.05 * random.uniform();
    if (i >= 600 && i < 700) pose.theta = wrap_angle(pose.theta + 0.09);
    if (i >= 700) pose.y -= 0.04;
  }
  return scans;
}

TEST(Spacing, LeavesNoGapThatIsLongerThanAskedByMoreThanOneStep) {
  const std::vector<PosedScan> all = drive();
  const SpacingConfig config{.spacing_m = 0.5};
  const std::vector<PosedScan> kept = spaced(all, config);
  ASSERT_LT(kept.size(), all.size() / 8);
  EXPECT_EQ(kept.front().scan.stamp, all.front().scan.stamp);
  EXPECT_EQ(kept.back().scan.stamp, all.back().scan.stamp);
  for (std::size_t i = 1; i < kept.size(); ++i) {
    const Pose2& a = kept[i - 1].map_from_robot;
    const Pose2& b = kept[i].map_from_robot;
    const double turn_rad = std::abs(angle_difference(a.theta, b.theta));
    const double gap_s = (kept[i].scan.stamp - kept[i - 1].scan.stamp).seconds();
    EXPECT_LT(translation_distance(a, b), 0.5 + 0.05);
    EXPECT_LT(turn_rad, 0.5 + 0.09 + 1e-9);
    EXPECT_LT(gap_s, 10.0 + 0.1 + 1e-9) << "a robot that stands is seen to stand";
    if (i + 1 == kept.size()) continue;
    EXPECT_TRUE(translation_distance(a, b) >= 0.5 || turn_rad >= 0.5 || gap_s >= 10.0);
  }
}

TEST(Spacing, KeepsTheLastScanWhereverTheDriveEnds) {
  const std::vector<PosedScan> all = drive();
  for (std::size_t size = all.size() - 20; size < all.size(); ++size) {
    const auto kept = spaced({all.data(), size}, {.spacing_m = 0.5});
    EXPECT_EQ(kept.back().scan.stamp, all[size - 1].scan.stamp) << size;
  }
}

TEST(Spacing, OfWhatIsSpacedIsTheSame) {
  const SpacingConfig config{.spacing_m = 0.3};
  const std::vector<PosedScan> once = spaced(drive(), config);
  EXPECT_EQ(spaced(once, config).size(), once.size());
}

TEST(Spacing, OfNothingIsNothingAndOfZeroIsAll) {
  EXPECT_TRUE(spaced({}, {.spacing_m = 1.0}).empty());
  const std::vector<PosedScan> all = drive();
  EXPECT_EQ(spaced(all, {}).size(), all.size());
  EXPECT_EQ(spaced({all.data(), 1}, {.spacing_m = 1.0}).size(), 1U);
}

}  // namespace
}  // namespace strata
