// SPDX-License-Identifier: Apache-2.0
#include "core/localization/unjudged_beams.hpp"

#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "tests/core/localization/unmapped_room.hpp"

namespace strata::localization {
namespace {

using unmapped_room::models;

/// One beam of that range, straight ahead.
Scan beam(double range_m) {
  Scan scan;
  scan.angle_increment_rad = 0.1F;
  scan.range_min_m = 0.05F;
  scan.range_max_m = 30.0F;
  scan.ranges_m = {static_cast<float>(range_m)};
  return scan;
}

bool is_unjudged(const SensorModel& model, const Pose2& from, double range_m) {
  std::vector<std::uint8_t> marks;
  model.find_unjudged(beam(range_m), from, marks);
  return marks.at(0) != 0;
}

TEST(UnjudgedBeams, AreThoseThatGoWhereNobodyHasBeen) {
  constexpr double kUp = std::numbers::pi / 2.0;
  constexpr double kNothing = std::numeric_limits<double>::infinity();
  for (const auto& model : models()) {
    EXPECT_FALSE(is_unjudged(*model, {2.0, 1.0, kUp}, 1.0)) << "the wall";
    EXPECT_FALSE(is_unjudged(*model, {2.0, 1.0, kUp}, 0.4)) << "something new before it";
    EXPECT_FALSE(is_unjudged(*model, {2.0, 1.0, kUp}, 3.0)) << "through the wall";
    EXPECT_TRUE(is_unjudged(*model, {8.5, 1.0, kUp}, 4.0)) << "through the gap into the room";
    EXPECT_FALSE(is_unjudged(*model, {8.5, 0.5, kUp}, 0.8)) << "a person before the gap";
    EXPECT_TRUE(is_unjudged(*model, {7.0, 4.0, -kUp}, 1.7)) << "the wall from its other side";
    EXPECT_FALSE(is_unjudged(*model, {7.0, 4.0, -kUp}, 3.8)) << "through it from there";
    EXPECT_TRUE(is_unjudged(*model, {8.5, 4.0, -kUp}, 4.0)) << "from the room through the gap";
    EXPECT_TRUE(is_unjudged(*model, {7.0, 4.0, kUp}, kNothing)) << "nothing, from the room";
    EXPECT_FALSE(is_unjudged(*model, {8.5, 1.0, kUp}, kNothing)) << "nothing, through the gap";
  }
}

TEST(UnjudgedBeams, OfReadingsThatSayNothingAreNone) {
  const Pose2 in_the_room{7.0, 4.0, 0.0};
  for (const float reading : {std::numeric_limits<float>::quiet_NaN(), 0.0F, -1.0F}) {
    for (const auto& model : models()) {
      EXPECT_FALSE(is_unjudged(*model, in_the_room, static_cast<double>(reading)));
    }
  }
}

TEST(UnjudgedBeams, OfScansWhoseIncrementIsBrokenComeToAnEnd) {
  constexpr float kUp = 0.5F * std::numbers::pi_v<float>;
  for (const float increment : {0.0F, 1e-38F, -1e-44F, std::numeric_limits<float>::infinity(),
                                std::numeric_limits<float>::quiet_NaN()}) {
    Scan scan = beam(4.0);
    scan.angle_min_rad = kUp;
    scan.angle_increment_rad = increment;
    scan.ranges_m.assign(5, 4.0F);
    const std::size_t together = beams_within(scan, kJudgedTogether_rad);
    EXPECT_EQ(together, std::abs(increment) > 0.0F && std::abs(increment) < 1.0F ? 5U : 1U);
    for (const auto& model : models()) {
      std::vector<std::uint8_t> marks;
      model->find_unjudged(scan, {8.5, 1.0, 0.0}, marks);
      ASSERT_EQ(marks.size(), 5U);
      EXPECT_TRUE(marks[0] == 1 || !std::isfinite(increment)) << increment;
    }
  }
}

/// Everything is known but x in [begin, end).
struct Gap {
  double begin_m, end_m;
  [[nodiscard]] bool knows(const Eigen::Vector2d& point_m) const {
    return point_m.x() < begin_m || point_m.x() >= end_m;
  }
};

TEST(UnknownWay, IsWhatOfTheWayIsUnknown) {
  const Eigen::Vector2d ahead(1.0, 0.0);
  for (const double end_m : {1.0, 1.5, 3.2}) {
    EXPECT_NEAR(unknown_way_m(Gap{1.0, end_m}, {0.0, 0.0}, ahead, 5.0), end_m - 1.0, 0.051);
    EXPECT_EQ(unknown_way_m(Gap{1.0, end_m}, {0.0, 0.0}, ahead, 0.9), 0.0);
    EXPECT_EQ(unknown_way_m(Gap{1.0, end_m}, {0.0, 0.0}, -ahead, 5.0), 0.0);
  }
  EXPECT_EQ(unknown_way_m(Gap{0.0, 9.0}, {1.0, 0.0}, ahead, -1.0), 0.0);
  EXPECT_NEAR(unknown_way_m(Gap{1.0, 1e9}, {0.0, 0.0}, ahead, 1e300, 0.32), 0.35, 1e-9) << "enough";
}

}  // namespace
}  // namespace strata::localization
