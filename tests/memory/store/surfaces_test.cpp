// SPDX-License-Identifier: Apache-2.0
#include <cstdint>

#include <gtest/gtest.h>

#include "core/random/stream.hpp"
#include "memory/store/store.hpp"
#include "tests/support/test_data.hpp"

namespace strata::memory {
namespace {

SurfaceLayer random_layer(std::size_t count) {
  RandomStream random(4, StreamId::kTest);
  const auto byte = [&] { return static_cast<std::uint8_t>(256.0 * random.uniform()); };
  SurfaceLayer layer{0.05, {}};
  for (std::size_t i = 0; i < count; ++i) {
    const auto number = static_cast<std::int32_t>(i);
    layer.cells.push_back({3 * number - 700, number / 7 - 30, byte(), byte(), byte(), byte()});
  }
  return layer;
}

TEST(Surfaces, ComeBackBitForBitAndAreListedAsNoGrid) {
  const test::TemporaryDirectory dir;
  const SurfaceLayer layer = random_layer(500);
  Store store(dir.path() / "strata.db");
  store.save_surfaces("filtered", layer);
  const SurfaceLayer back = store.load_surfaces("filtered");
  EXPECT_EQ(back.resolution_m, layer.resolution_m);
  EXPECT_EQ(back.cells, layer.cells);
  EXPECT_TRUE(store.grid_names().empty());
}

TEST(Surfaces, AreReplacedAlsoByNone) {
  const test::TemporaryDirectory dir;
  Store store(dir.path() / "strata.db");
  store.save_surfaces("filtered", random_layer(20));
  store.save_surfaces("filtered", {});
  EXPECT_TRUE(store.load_surfaces("filtered").cells.empty());
}

TEST(Surfaces, AreNoneInAStoreOfBefore) {
  const test::TemporaryDirectory dir;
  const Store store(dir.path() / "strata.db");
  EXPECT_TRUE(store.load_surfaces("filtered").cells.empty());
}

}  // namespace
}  // namespace strata::memory
