// SPDX-License-Identifier: Apache-2.0
#include "core/base/time.hpp"

#include <gtest/gtest.h>

namespace strata {
namespace {

TEST(Stamp, RoundsSecondsToTheNearestNanosecond) {
  EXPECT_EQ(Stamp::from_seconds(0.1).ns, 100'000'000);
  EXPECT_EQ(Stamp::from_seconds(-1e-9).ns, -1);
  EXPECT_EQ(Duration::from_seconds(0.6e-9).ns, 1);
}

TEST(Stamp, DifferencesAndSumsAreExactFarFromTheEpoch) {
  const Stamp late{1'700'000'000'000'000'001};
  const Stamp later = late + Duration{7};
  EXPECT_EQ((later - late).ns, 7);
  EXPECT_EQ(later - Duration{7}, late);
  EXPECT_LT(late, later);
  EXPECT_EQ((Duration{5} - Duration{8}).ns, -3);
}

}  // namespace
}  // namespace strata
