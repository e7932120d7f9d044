// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/paced_time.hpp"

#include <gtest/gtest.h>

namespace strata::tools {
namespace {

TEST(PacedTime, KeepsTheRateAndCutsNightsShort) {
  PacedTime time(10.0);
  EXPECT_DOUBLE_EQ(time.due_s(0.0), 0.0);
  EXPECT_DOUBLE_EQ(time.due_s(2.0), 0.2);
  EXPECT_DOUBLE_EQ(time.due_s(7.0), 0.7);
  EXPECT_DOUBLE_EQ(time.due_s(3'607.0), 1.2) << "an hour is shown as five seconds";
  EXPECT_DOUBLE_EQ(time.due_s(3'608.0), 1.3);
}

TEST(PacedTime, DoesNotWaitAgainWhereStampsGoBack) {
  PacedTime time(1.0);
  EXPECT_DOUBLE_EQ(time.due_s(1.0), 1.0);
  EXPECT_DOUBLE_EQ(time.due_s(0.4), 1.0);
  EXPECT_DOUBLE_EQ(time.due_s(0.6), 1.2);
}

}  // namespace
}  // namespace strata::tools
