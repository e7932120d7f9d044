// SPDX-License-Identifier: Apache-2.0
// A real run localized in maps of two others, between which doors changed.
#include "tools/laboratory/experiments/wean.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/support/test_data.hpp"
#include "tools/laboratory/experiments/wean_doors.hpp"

namespace strata::experiments {
namespace {

/// Of two seeds: the worse error, and the sums of what must not happen at all.
WeanOutcome worst_of(const WeanRuns& wean, int run, const WeanMaps& learned,
                     const std::vector<int>& of, const std::string& model) {
  WeanOutcome worst;
  for (const std::uint64_t seed : {1U, 2U}) {
    const WeanOutcome one = localize_wean_run(wean, run, learned, of, model, seed, 2);
    worst.reference.mean_m = std::max(worst.reference.mean_m, one.reference.mean_m);
    worst.common.mean_m = std::max(worst.common.mean_m, one.common.mean_m);
    worst.is_lost = worst.is_lost || one.is_lost;
    worst.lost_scans += one.lost_scans;
    worst.lost_beyond_scans += one.lost_beyond_scans;
  }
  return worst;
}

TEST(WeanRotation, Run3IsLocalizedWithTheDoorsOfRuns1And2AsWellAsInTheBetterMapOfOneRun) {
  STRATA_REQUIRE_DATA(folder, "wean_hall");
  const WeanRuns wean = read_wean_runs(folder, 2);
  const std::vector<int> learned{0, 1};
  const WeanMaps both = learn_wean_maps(wean, learned, true, 2);
  const WeanDoors doors = judge_wean_doors(*both.maps.patches, 0, 1);
  EXPECT_EQ(doors.changed.size(), 5U);
  for (const std::size_t d : {1U, 2U, 3U, 4U}) {
    EXPECT_EQ(std::count(doors.right.begin(), doors.right.end(), d), 1) << d;
  }
  EXPECT_LE(doors.elsewhere, 4U);

  const WeanOutcome patch = worst_of(wean, 2, both, learned, "patch");
  EXPECT_FALSE(patch.is_lost);
  EXPECT_EQ(patch.lost_scans + patch.lost_beyond_scans, 0U);
  const WeanMaps coherent = learn_wean_maps(wean, learned, true, 2, kWeanCoherentStddev_m);
  EXPECT_LT(worst_of(wean, 2, coherent, learned, "patch").common.mean_m, 0.08);
  WeanError better{1e9, 1e9};
  for (const int run : learned) {
    const WeanMaps single = learn_wean_maps(wean, {run}, true, 2);
    const WeanOutcome outcome = worst_of(wean, 2, single, {run}, "filtered");
    better.mean_m = std::min(better.mean_m, outcome.reference.mean_m);
  }
  EXPECT_LT(patch.reference.mean_m, better.mean_m + 0.05);
}

// The table says that four doors changed between them; the scans say that none did.
TEST(WeanRotation, Runs2And3SawNoDoorInTwoStatesAndGiveNoneToThePatchMap) {
  STRATA_REQUIRE_DATA(folder, "wean_hall");
  const WeanRuns wean = read_wean_runs(folder, 2);
  const patch::PatchLearnerConfig config;
  patch::VisitTable visits = patch::find_visits(wean.scans, 0.05, config.visits, config.counting);
  visits.filter(config.contradiction.prior);
  for (const WeanDoor& door : wean_doors()) {
    EXPECT_EQ(cells_apart(visits, wean.scans, door, 1, 2), 0U) << door.middle_m.transpose();
  }
  for (const std::size_t d : {2U, 3U, 4U}) {
    EXPECT_GT(cells_apart(visits, wean.scans, wean_doors()[d], 0, 1), 8U) << d;
  }
  const WeanMaps both = learn_wean_maps(wean, {1, 2}, true, 2);
  const WeanDoors doors = judge_wean_doors(*both.maps.patches, 1, 2);
  EXPECT_TRUE(doors.right.empty());
  EXPECT_LE(doors.elsewhere, 2U);
  EXPECT_EQ(doors.elsewhere, both.maps.patches->submaps.size());
  const WeanOutcome patch = worst_of(wean, 0, both, {1, 2}, "patch");
  EXPECT_FALSE(patch.is_lost);
  EXPECT_LT(patch.common.mean_m, 0.10);
}

}  // namespace
}  // namespace strata::experiments
