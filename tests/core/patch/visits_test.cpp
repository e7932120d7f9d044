// SPDX-License-Identifier: Apache-2.0
#include "core/patch/visits.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "tests/core/patch/toy_world.hpp"

namespace strata::patch {
namespace {

using test_world::beam;

TEST(Visits, GapAndRunEndThem) {
  std::vector<PosedScan> scans;
  for (const double t : {0.0, 5.0, 14.9, 25.0, 30.0}) scans.push_back(beam(1.0, t));
  scans.push_back(beam(1.0, 30.5, 1));
  const VisitTable table = find_visits(scans, 0.05, {}, {});
  const auto visits = table.at({20, 0});
  ASSERT_EQ(visits.size(), 3U);
  EXPECT_EQ(visits[0].first_scan, 0U);
  EXPECT_EQ(visits[0].last_scan, 2U);
  EXPECT_EQ(visits[0].hits, 3.0F);
  EXPECT_EQ(visits[1].hits, 2.0F);
  EXPECT_EQ(visits[2].first_scan, 5U);
}

TEST(Visits, CountPassingBeamsByLengthAndOnlyWhereSomethingWasHit) {
  const std::vector<PosedScan> scans{beam(0.5, 0.0), beam(2.0, 0.1)};
  const VisitTable table = find_visits(scans, 0.05, {}, {});
  const auto visits = table.at({10, 0});
  ASSERT_EQ(visits.size(), 1U);
  EXPECT_EQ(visits[0].hits, 1.0F);
  EXPECT_NEAR(visits[0].misses, 1.0F, 1e-5F);
  EXPECT_TRUE(table.at({5, 0}).empty()) << "never hit, so it cannot contradict itself";
  EXPECT_EQ(table.cells().size(), 2U);
}

TEST(Visits, TheLastPieceOfABeamSaysNothingAboutFreeSpace) {
  const std::vector<PosedScan> scans{beam(1.0, 0.0), beam(1.175, 0.1), beam(2.0, 0.2)};
  VisitConfig config;
  config.end_reach_m = 0.2;
  EXPECT_NEAR(find_visits(scans, 0.05, config, {}).at({20, 0})[0].misses, 1.0F, 1e-5F);
  config.end_reach_m = 0.0;
  EXPECT_NEAR(find_visits(scans, 0.05, config, {}).at({20, 0})[0].misses, 2.0F, 1e-5F);
}

TEST(Visits, KnowTheDirectionsOfPassingBeamsAlsoOnceFiltered) {
  const std::vector<PosedScan> scans{beam(1.0, 0.0), beam(2.0, 0.1), beam(2.0, 0.2)};
  VisitTable table = find_visits(scans, 0.05, {}, {});
  const Visit before = table.at({20, 0})[0];
  EXPECT_NEAR(before.passing.cos2, before.misses, 1e-5F) << "all along x";
  EXPECT_NEAR(before.passing.sin2, 0.0F, 1e-5F);
  table.filter(0.6);
  const Visit after = table.at({20, 0})[0];
  EXPECT_GT(after.misses, before.misses + 0.5F) << "else nothing was filtered";
  EXPECT_NEAR(after.passing.cos2, after.misses, 1e-5F);
}

// A week and a half at 40 scans a second; of ten beams a scan, a day.
TEST(Visits, OfARobotThatStandsForDaysKeepTheirSharesAndTheirBitsBeforeThat) {
  Visit visit;
  constexpr int kOrdinary = 1 << 22;
  constexpr int kScans = 9 * kOrdinary;
  for (int i = 0; i < kScans; ++i) {
    // One of four beams ends there.
    visit.add(i % 4 == 0, 1.0F, {1.0F, 0.0F});
    if (i + 1 == kOrdinary) {
      EXPECT_EQ(visit.hits, static_cast<float>(kOrdinary / 4));
      EXPECT_EQ(visit.misses, static_cast<float>(kOrdinary / 4 * 3));
    }
  }
  EXPECT_NEAR(static_cast<double>(visit.hits) / visit.total(), 0.25, 1e-6);
  EXPECT_EQ(visit.passing.cos2, visit.misses) << "all passed that way";
  EXPECT_GT(visit.total(), 2e6);
}

TEST(Visits, EndAtTheRangeLimit) {
  VisitConfig config;
  config.max_range_m = 1.0;
  const std::vector<PosedScan> scans{beam(0.5, 0.0), beam(2.0, 0.1)};
  const VisitTable table = find_visits(scans, 0.05, config, {});
  EXPECT_EQ(table.at({10, 0}).size(), 1U);
  EXPECT_TRUE(table.at({40, 0}).empty());
}

TEST(Visits, FilterRemovesPeopleAndKeepsWhatStays) {
  std::vector<PosedScan> scans;
  scans.push_back(beam(0.5, 0.0));  // someone walks by
  for (int i = 1; i < 20; ++i) scans.push_back(beam(1.0, 0.1 * i));
  VisitTable table = find_visits(scans, 0.05, {}, {});
  table.filter(0.9);
  EXPECT_EQ(table.at({10, 0})[0].hits, 0.0F) << "1 in 20 is below (1 - p) / p";
  EXPECT_NEAR(table.at({10, 0})[0].total(), 20.0, 1e-4);
  EXPECT_EQ(table.at({20, 0})[0].hits, 19.0F);
}

TEST(Visits, ScansWithoutAnyReturnGiveAnEmptyTable) {
  const std::vector<PosedScan> scans{beam(std::numeric_limits<double>::infinity(), 0.0),
                                     beam(std::numeric_limits<double>::quiet_NaN(), 0.1)};
  EXPECT_TRUE(find_visits(scans, 0.05, {}, {}).cells().empty());
  EXPECT_TRUE(find_visits({}, 0.05, {}, {}).cells().empty());
}

}  // namespace
}  // namespace strata::patch
