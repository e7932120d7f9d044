// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/time_histogram.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace strata::runtime {
namespace {

TEST(TimeHistogram, CountsTimesUpToEachBoundAndTheirSum) {
  TimeHistogram times;
  times.add(0.001);  // a bound belongs to what is below it
  times.add(0.0015);
  times.add(0.3);
  times.add(7.0);
  EXPECT_EQ(times.text(),
            "0.0005:0 0.001:1 0.002:2 0.005:2 0.01:2 0.02:2 0.05:2 0.1:2 0.2:2 0.5:3 1:3 inf:4 "
            "sum:7.3025");
  EXPECT_EQ(times.count(), 4U);
}

TEST(TimeHistogram, TakesWhatIsNoTimeWithoutSpoilingTheSum) {
  TimeHistogram times;
  times.add(-3.0);
  times.add(std::numeric_limits<double>::quiet_NaN());
  times.add(std::numeric_limits<double>::infinity());
  EXPECT_EQ(times.text(),
            "0.0005:1 0.001:1 0.002:1 0.005:1 0.01:1 0.02:1 0.05:1 0.1:1 0.2:1 0.5:1 1:1 inf:3 "
            "sum:0");
}

}  // namespace
}  // namespace strata::runtime
