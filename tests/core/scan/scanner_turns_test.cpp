// SPDX-License-Identifier: Apache-2.0
#include "core/scan/scanner_turns.hpp"

#include <map>
#include <vector>

#include <gtest/gtest.h>

namespace strata {
namespace {

Scan from(double x_m) {
  Scan scan;
  scan.robot_from_laser = {x_m, 0.0, 0.0};
  return scan;
}

TEST(ScannerTurns, OneScannerAlwaysHasItsTurn) {
  ScannerTurns turns;
  for (int i = 0; i < 100; ++i) {
    turns.see(from(0.3));
    EXPECT_TRUE(turns.has_turn());
    turns.use();
  }
  EXPECT_EQ(turns.alive(), 1U);
}

TEST(ScannerTurns, ScannersInStepAreUsedByTurns) {
  ScannerTurns turns;
  std::map<double, int> used;
  for (int place = 0; place < 100; ++place) {
    bool is_taken = false;
    for (const double x : {0.3, -0.3, 0.0}) {
      turns.see(from(x));
      if (is_taken || !turns.has_turn()) continue;
      turns.use();
      is_taken = true;
      ++used[x];
    }
    EXPECT_TRUE(is_taken);
  }
  EXPECT_EQ(turns.alive(), 3U);
  for (const auto& [x, count] : used) EXPECT_NEAR(count, 100.0 / 3.0, 1.0) << x;
}

TEST(ScannerTurns, ASlowOrSilentScannerHoldsNobodyUp) {
  ScannerTurns turns;
  turns.see(from(-0.3));
  turns.use();
  int in_a_row = 0;
  for (int i = 0; i < 100; ++i) {
    turns.see(from(0.3));
    if (turns.has_turn()) {
      turns.use();
      in_a_row = 0;
    } else {
      EXPECT_LE(++in_a_row, 1);
    }
  }
  EXPECT_EQ(turns.alive(), 1U);
  EXPECT_EQ(in_a_row, 0);
}

TEST(ScannerTurns, AnotherRunBeginsAnew) {
  ScannerTurns turns;
  turns.see(from(0.3), 1);
  turns.see(from(-0.3), 1);
  EXPECT_EQ(turns.alive(), 2U);
  turns.see(from(0.3), 2);
  EXPECT_EQ(turns.alive(), 1U);
  EXPECT_TRUE(turns.has_turn());
}

}  // namespace
}  // namespace strata
