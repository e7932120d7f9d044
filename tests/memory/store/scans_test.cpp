// SPDX-License-Identifier: Apache-2.0
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/random/stream.hpp"
#include "memory/store/store.hpp"
#include "tests/memory/store/execute_sql.hpp"
#include "tests/support/same_scan.hpp"
#include "tests/support/test_data.hpp"

namespace strata::memory {
namespace {

using strata::test::expect_same_scan;
using strata::test::same_bits;

using test::TemporaryDirectory;
using testing::ElementsAre;
using testing::IsEmpty;

/// Scans of every shape: beam counts that change, no beams, readings that are no numbers.
std::vector<PosedScan> random_scans(int run, std::size_t count) {
  RandomStream random(3, StreamId::kTest);
  std::vector<PosedScan> scans;
  for (std::size_t i = 0; i < count; ++i) {
    PosedScan& posed = scans.emplace_back();
    posed.run = run;
    posed.map_from_robot = {random.normal(), random.normal(), random.uniform()};
    posed.scan.stamp = {static_cast<std::int64_t>(i) * 25'000'001};
    posed.scan.robot_from_laser = {0.1, -0.0, 0.01};
    posed.scan.angle_min_rad = -1.5F;
    posed.scan.angle_increment_rad = 0.01F;
    posed.scan.time_increment_s = 1e-5F;
    posed.scan.scan_time_s = 0.025F;
    posed.scan.range_min_m = 0.05F;
    posed.scan.range_max_m = std::numeric_limits<float>::infinity();
    posed.scan.ranges_m.resize(i % 7 * 10);
    for (float& range : posed.scan.ranges_m) range = static_cast<float>(random.exponential(5.0));
    if (!posed.scan.ranges_m.empty()) {
      posed.scan.ranges_m.front() = std::numeric_limits<float>::quiet_NaN();
    }
    if (i % 2 == 0) {
      posed.static_probability.assign(posed.scan.size(), static_cast<float>(random.uniform()));
    }
  }
  return scans;
}

TEST(StoredScans, ComeBackBitForBit) {
  const TemporaryDirectory dir;
  const std::vector<PosedScan> saved = random_scans(4, 600);
  {
    Store store(dir.path() / "strata.db");
    store.save_scans(4, saved);
  }
  const Store store(dir.path() / "strata.db", {.read_only = true});
  EXPECT_THAT(store.runs_with_scans(), ElementsAre(4));
  const std::vector<PosedScan> loaded = store.load_scans(4);
  ASSERT_EQ(loaded.size(), saved.size());
  for (std::size_t i = 0; i < saved.size(); ++i) {
    SCOPED_TRACE("scan " + std::to_string(i));
    expect_same_scan(saved[i].scan, loaded[i].scan);
    EXPECT_EQ(loaded[i].run, 4);
    EXPECT_EQ(saved[i].map_from_robot, loaded[i].map_from_robot);
    EXPECT_TRUE(same_bits(saved[i].static_probability, loaded[i].static_probability));
  }
}

TEST(StoredScans, OfARunAreReplacedAsAWhole) {
  const TemporaryDirectory dir;
  Store store(dir.path() / "strata.db");
  store.save_scans(0, random_scans(0, 600));
  store.save_scans(1, random_scans(1, 3));
  store.save_scans(0, random_scans(0, 5));
  EXPECT_EQ(store.load_scans(0).size(), 5U);
  EXPECT_EQ(store.load_scans(1).size(), 3U);
  EXPECT_THAT(store.load_scans(2), IsEmpty());
  EXPECT_THAT(store.runs_with_scans(), ElementsAre(0, 1));
}

TEST(StoredScans, ThatAreAppendedFollowThoseOfTheirRun) {
  const TemporaryDirectory dir;
  Store store(dir.path() / "strata.db");
  const auto saved = random_scans(0, 600);
  const std::span<const PosedScan> all(saved);
  store.append_scans(0, all.first(300));
  store.append_scans(1, random_scans(1, 2));
  store.append_scans(0, all.subspan(300, 1));
  store.append_scans(0, {});
  store.append_scans(0, all.subspan(301));
  const auto loaded = store.load_scans(0);
  ASSERT_EQ(loaded.size(), saved.size());
  for (std::size_t i = 0; i < saved.size(); ++i) {
    EXPECT_EQ(loaded[i].scan.stamp, saved[i].scan.stamp) << i;
    EXPECT_TRUE(same_bits(saved[i].scan.ranges_m, loaded[i].scan.ranges_m)) << i;
  }
  EXPECT_EQ(store.load_scans(1).size(), 2U);
}

TEST(StoredScans, ThatDoNotAddUpAreRefusedByPlace) {
  const TemporaryDirectory dir;
  { Store(dir.path() / "strata.db").save_scans(0, random_scans(0, 10)); }
  test::execute(dir.path() / "strata.db", "UPDATE scan_chunk SET scans = 9");
  const Store store(dir.path() / "strata.db");
  try {
    (void)store.load_scans(0);
    FAIL() << "read";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("scans of run 0, chunk 0"));
  }
}

TEST(StoredScans, AreAddedToAStoreOfVersionOne) {
  const TemporaryDirectory dir;
  { Store(dir.path() / "strata.db").save_text("kept", "yes"); }
  test::execute(dir.path() / "strata.db", "DROP TABLE scan_chunk; PRAGMA user_version = 1");
  {
    const Store reader(dir.path() / "strata.db", {.read_only = true});
    EXPECT_THAT(reader.runs_with_scans(), IsEmpty());
    EXPECT_THAT(reader.load_scans(0), IsEmpty());
  }
  Store store(dir.path() / "strata.db");
  store.save_scans(0, random_scans(0, 2));
  EXPECT_EQ(store.load_scans(0).size(), 2U);
  EXPECT_EQ(store.find_text("kept"), "yes");
}

}  // namespace
}  // namespace strata::memory
