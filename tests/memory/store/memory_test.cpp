// SPDX-License-Identifier: Apache-2.0
/// What saving takes beside what is saved.
#include <cstddef>
#include <optional>

#include <gtest/gtest.h>

#include "memory/store/store.hpp"
#include "tests/support/peak_memory.hpp"
#include "tests/support/test_data.hpp"

namespace strata::memory {
namespace {

constexpr CellRect kLarge{{-1000, -1000}, {2000, 2000}};
/// Of a window of the packer, of the packed map, of pages of the store.
constexpr std::size_t kMost_bytes = 20'000'000;

TEST(MemoryOfSaving, TheMapOfALargeBuildingIsNotCopied) {
  const test::TemporaryDirectory directory;
  Store store(directory.path() / "strata.db");
  ReflectionGrid grid = make_reflection_grid(0.05, kLarge);
  for (int i = 0; i < 2000; ++i) grid.at({i, i / 2}) = 0.5F;
  const std::optional<std::size_t> more_bytes =
      test::peak_growth_bytes([&] { store.save_grid("map", grid); });
  if (!more_bytes) GTEST_SKIP() << "the peak cannot be measured here";
  ASSERT_GT(grid.size() * sizeof(float), kMost_bytes);
  EXPECT_LT(*more_bytes, kMost_bytes);
}

TEST(MemoryOfSaving, CountsInTilesAreNotSpreadOverTheirBox) {
  const test::TemporaryDirectory directory;
  Store store(directory.path() / "strata.db");
  TiledGrid<CellCounts> counts(0.05, kLarge);
  for (int i = 0; i < 2000; ++i) counts.at({i, i / 2}) = {1.0, 0.25};
  const std::optional<std::size_t> more_bytes =
      test::peak_growth_bytes([&] { store.save_grid("counts", counts); });
  if (!more_bytes) GTEST_SKIP() << "the peak cannot be measured here";
  ASSERT_GT(counts.size() * sizeof(CellCounts), kMost_bytes);
  EXPECT_LT(*more_bytes, kMost_bytes);
}

}  // namespace
}  // namespace strata::memory
