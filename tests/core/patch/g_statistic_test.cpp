// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/patch/contradiction.hpp"

namespace strata::patch {
namespace {

TEST(ChiSquared, TailMatchesPublishedQuantiles) {
  // Upper 5% points from the standard table.
  EXPECT_NEAR(chi_squared_tail(3.841458821, 1), 0.05, 1e-9);
  EXPECT_NEAR(chi_squared_tail(5.991464547, 2), 0.05, 1e-9);
  EXPECT_NEAR(chi_squared_tail(7.814727903, 3), 0.05, 1e-9);
  EXPECT_NEAR(chi_squared_tail(18.30703805, 10), 0.05, 1e-9);
  EXPECT_NEAR(chi_squared_tail(19.67513757, 11), 0.05, 1e-9);
  // The thresholds at 1e-4 for 2, 3 and 4 visits: docs/theory/patch_maps.md, "Few visits".
  EXPECT_NEAR(chi_squared_tail(15.1367, 1), 1e-4, 1e-6);
  EXPECT_NEAR(chi_squared_tail(18.4207, 2), 1e-4, 1e-6);
  EXPECT_NEAR(chi_squared_tail(21.1075, 3), 1e-4, 1e-6);
  EXPECT_DOUBLE_EQ(chi_squared_tail(0.0, 1), 1.0);
  EXPECT_DOUBLE_EQ(chi_squared_tail(0.0, 4), 1.0);
}

TEST(GStatistic, MatchesHandComputedValues) {
  // Two opposite visits of 4 beams: r = 1/2 pooled, G = 2 * 8 ln 2.
  EXPECT_NEAR(g_statistic(std::vector<VisitEvidence>{{4, 0}, {0, 4}}), 16.0 * std::log(2.0), 1e-12);
  // One occupied, two free: 2 (4 ln 3 + 8 ln 1.5) = 15.276.
  EXPECT_NEAR(g_statistic(std::vector<VisitEvidence>{{4, 0}, {0, 4}, {0, 4}}),
              2.0 * (4.0 * std::log(3.0) + 8.0 * std::log(1.5)), 1e-12);
  // Equal shares: nothing to explain.
  EXPECT_NEAR(g_statistic(std::vector<VisitEvidence>{{1, 3}, {0.5, 1.5}, {1, 3}}), 0.0, 1e-12);
  // h = 3, f = 1 against h = 1, f = 3: 2 (2 * 3 ln 1.5 + 2 ln 0.5).
  EXPECT_NEAR(g_statistic(std::vector<VisitEvidence>{{3, 1}, {1, 3}}),
              2.0 * (6.0 * std::log(1.5) + 2.0 * std::log(0.5)), 1e-12);
}

TEST(GStatistic, CappedEvidenceOfFewVisitsCannotReachTheThreshold) {
  // Why the pooled test exists (docs/theory/patch_maps.md, "Few visits"): with 4 beams a visit the
  // best that 2 and 3 visits can show is short of significance, 4 visits just reach it.
  const ContradictionConfig config;
  EXPECT_GT(chi_squared_tail(g_statistic(std::vector<VisitEvidence>{{4, 0}, {0, 4}}), 1),
            config.significance);
  EXPECT_GT(chi_squared_tail(g_statistic(std::vector<VisitEvidence>{{4, 0}, {0, 4}, {0, 4}}), 2),
            config.significance);
  EXPECT_LT(
      chi_squared_tail(g_statistic(std::vector<VisitEvidence>{{4, 0}, {0, 4}, {4, 0}, {0, 4}}), 3),
      config.significance);
}

}  // namespace
}  // namespace strata::patch
