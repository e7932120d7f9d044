// SPDX-License-Identifier: Apache-2.0
#include "core/scan/drop_out_watch.hpp"

#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/base/parallel.hpp"
#include "core/base/state_archive.hpp"
#include "tests/core/scan/corridor_drive.hpp"

namespace strata {
namespace {

using namespace test;

TEST(DropOutWatch, BelievesBeamsAsFarAsTheWholeLogDoesOnceItHasSeenEnough) {
  for (const double drop : {0.01, 0.3}) {
    Drive d = drive(corridor, always(drop), 40.0);
    DropOutWatch watch;
    for (PosedScan& scan : d.scans) watch.take(scan);
    const float last = d.scans.back().scan.free_range_m;
    EXPECT_EQ(d.scans.front().scan.free_range_m, 0.0F) << "nothing is known yet";
    EXPECT_FLOAT_EQ(static_cast<float>(watch.found().free_range_m), last);
    WorkerPool pool(1);
    const DropOuts found = find_drop_outs(d.scans, {}, pool);
    EXPECT_FLOAT_EQ(static_cast<float>(found.free_range_m), last) << drop;
    EXPECT_EQ(last > 0.0F, drop < 0.1);
  }
}

TEST(DropOutWatch, TellsMostReturnsThatDroppedOutByWhatTheScansBeforeShowed) {
  Drive d = drive(corridor, always(0.01), 40.0);
  DropOutWatch watch;
  std::size_t lost = 0;
  std::size_t told = 0;
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < d.scans.size(); ++i) {
    Scan& scan = d.scans[i].scan;
    watch.take(d.scans[i]);
    if (scan.free_range_m == 0.0F) continue;
    for (const std::uint32_t beam : scan.drop_outs) ++(d.lost[i][beam] ? told : wrong);
    for (const bool one : d.lost[i]) lost += one ? 1U : 0U;
  }
  EXPECT_GT(lost, 100U);
  EXPECT_GT(static_cast<double>(told), 0.85 * static_cast<double>(lost));
  EXPECT_LT(static_cast<double>(wrong), 0.1 * static_cast<double>(told));
}

TEST(DropOutWatch, BeamsOfAScanWithoutOneShortlyBeforeSayNothing) {
  Drive d = drive(corridor, always(0.01), 40.0);
  DropOutWatch watch;
  for (std::size_t i = 0; i < d.scans.size(); ++i) {
    const bool is_late = i + 2 >= d.scans.size();
    d.scans[i].scan.stamp.ns += is_late ? 60'000'000'000 : 0;
    watch.take(d.scans[i]);
  }
  const std::size_t last = d.scans.size() - 1;
  EXPECT_GT(d.scans[last - 2].scan.free_range_m, 0.0F);
  EXPECT_EQ(d.scans[last - 1].scan.free_range_m, 0.0F);
  EXPECT_GT(d.scans[last].scan.free_range_m, 0.0F);
}

TEST(DropOutWatch, AGateThatOpensIsSeenSomeScansLater) {
  Drive d = drive(gate_that_opens(6.0), always(0.002));
  DropOutWatch watch;
  for (PosedScan& scan : d.scans) watch.take(scan);
  EXPECT_GT(silent_between(d, 6.0, 6.5), 20U);
  EXPECT_LT(silent_between(d, 9.05, 9.5), 5U);
}

TEST(DropOutWatch, GoesOnBitForBitFromASavedState) {
  Drive whole = drive(corridor, always(0.01));
  Drive parts = drive(corridor, always(0.01));
  DropOutWatch watch;
  auto stopped = DropOutWatch();
  for (std::size_t i = 0; i < whole.scans.size(); ++i) {
    watch.take(whole.scans[i]);
    stopped.take(parts.scans[i]);
    ASSERT_EQ(parts.scans[i].scan.free_range_m, whole.scans[i].scan.free_range_m);
    ASSERT_EQ(parts.scans[i].scan.drop_outs, whole.scans[i].scan.drop_outs);
    if (i % 7 != 3) continue;
    StateWriter writer;
    writer(stopped);
    const std::vector<std::uint8_t> bytes = writer.take();
    stopped = DropOutWatch();
    StateReader reader(bytes, "state");
    reader(stopped);
    reader.expect_end();
  }
  EXPECT_EQ(stopped.found(), watch.found());
}

TEST(DropOutWatch, RefusesAScannerThatHasNoScans) {
  StateWriter writer;
  writer(std::uint64_t{1});  // a scanner
  writer(std::uint64_t{0});  // without scans
  for (int i = 0; i < 40; ++i) writer(std::uint64_t{0});
  const std::vector<std::uint8_t> bytes = writer.take();
  DropOutWatch watch;
  StateReader reader(bytes, "state");
  EXPECT_THROW(reader(watch), InputError);
}

TEST(DropOutWatch, IsBoundedWhereEveryScanComesFromAnotherScanner) {
  Drive d = drive(corridor, always(0.01));
  DropOutWatch watch;
  for (std::size_t i = 0; i < d.scans.size(); ++i) {
    d.scans[i].scan.robot_from_laser.x = 0.001 * static_cast<double>(i);
    watch.take(d.scans[i]);
  }
  StateWriter writer;
  writer(watch);
  EXPECT_LT(writer.take().size(), 8U * 1500U) << "eight scans";
}

}  // namespace
}  // namespace strata
