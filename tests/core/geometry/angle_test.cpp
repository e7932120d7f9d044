// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/angle.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "core/random/stream.hpp"

namespace strata {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(WrapAngle, KeepsTheDirectionWithinMinusPiToPi) {
  RandomStream random(1, StreamId::kTest);
  for (int i = 0; i < 100'000; ++i) {
    const double angle = random.uniform(-100.0, 100.0);
    const double wrapped = wrap_angle(angle);
    ASSERT_GT(wrapped, -kPi);
    ASSERT_LE(wrapped, kPi);
    ASSERT_NEAR(std::remainder(wrapped - angle, 2.0 * kPi), 0.0, 1e-12);
  }
}

TEST(WrapAngle, IsHalfOpenAtEveryMultipleOfPi) {
  for (int k = -1000; k <= 1000; ++k) {
    for (const double nudge : {-1e-15, 0.0, 1e-15}) {
      const double wrapped = wrap_angle(k * kPi + nudge);
      ASSERT_GT(wrapped, -kPi);
      ASSERT_LE(wrapped, kPi);
    }
  }
  EXPECT_EQ(wrap_angle(kPi), kPi);
  EXPECT_EQ(wrap_angle(-kPi), kPi);
  EXPECT_EQ(wrap_angle(std::nextafter(-kPi, 0.0)), std::nextafter(-kPi, 0.0));
}

TEST(WrapAngle, GivesNanForWhatIsNoAngle) {
  EXPECT_TRUE(std::isnan(wrap_angle(std::numeric_limits<double>::infinity())));
  EXPECT_TRUE(std::isnan(wrap_angle(std::numeric_limits<double>::quiet_NaN())));
}

TEST(AngleDifference, GoesTheShortWay) {
  EXPECT_NEAR(angle_difference(3.0, -3.0), 6.0 - 2.0 * kPi, 1e-15);
  EXPECT_NEAR(angle_difference(-3.0, 3.0), 2.0 * kPi - 6.0, 1e-15);
  EXPECT_NEAR(angle_difference(degrees_to_radians(10.0), degrees_to_radians(350.0)),
              degrees_to_radians(20.0), 1e-14);
  EXPECT_NEAR(radians_to_degrees(kPi), 180.0, 1e-12);
}

}  // namespace
}  // namespace strata
