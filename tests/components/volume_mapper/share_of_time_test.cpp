// SPDX-License-Identifier: Apache-2.0
#include "components/volume_mapper/share_of_time.hpp"

#include <gtest/gtest.h>

namespace strata::volume_mapper {
namespace {

using std::chrono::milliseconds;

TEST(ShareOfTime, WhatTookLongWaitsNineTimesAsLong) {
  const ShareOfTime::Clock::time_point begin{std::chrono::hours(1)};
  ShareOfTime share;
  EXPECT_TRUE(share.is_due(begin));
  share.spent(begin, begin + milliseconds(100));
  EXPECT_FALSE(share.is_due(begin + milliseconds(999)));
  EXPECT_TRUE(share.is_due(begin + milliseconds(1000)));
}

TEST(ShareOfTime, IsOneTenthHoweverLongItTakes) {
  const ShareOfTime::Clock::time_point begin{std::chrono::hours(1)};
  ShareOfTime share;
  auto now = begin;
  auto spent = milliseconds(0);
  for (int i = 0; i < 100'000; ++i, now += milliseconds(1)) {
    if (!share.is_due(now)) continue;
    const milliseconds took(5 + i / 1000);
    share.spent(now, now + took);
    spent += took;
    now += took;
  }
  const double part = std::chrono::duration<double>(spent) / (now - begin);
  EXPECT_NEAR(part, 0.1, 0.001);
}

}  // namespace
}  // namespace strata::volume_mapper
