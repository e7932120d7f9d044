// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "core/grid/grid_state.hpp"
#include "core/registration/match_field.hpp"

namespace strata::registration {
namespace {

constexpr CellRect kRect{{0, 0}, {3, 2}};

/// A saved field of one point to which every cell is nearest, but for one that names `index`.
std::vector<std::uint8_t> field_naming(std::int32_t index, const CellRect& distances = kRect) {
  Grid<std::int32_t> nearest(0.1, kRect, 0);
  nearest.at({2, 1}) = index;
  StateWriter writer;
  writer(std::vector<SurfacePoint>(1));
  writer(nearest);
  writer(Grid<float>(0.1, distances, 0.5F));
  return writer.take();
}

TEST(MatchFieldState, IsRefusedWhenACellNamesAPointThatIsNotThere) {
  const auto read = [](const std::vector<std::uint8_t>& bytes) {
    MatchField field(0.1, MatchFieldConfig{});
    StateReader reader(bytes, "state");
    reader(field);
    reader.expect_end();
  };
  EXPECT_NO_THROW(read(field_naming(0)));
  EXPECT_NO_THROW(read(field_naming(-1)));
  for (const std::int32_t index : {1, 1'000'000, -2}) {
    EXPECT_THROW(read(field_naming(index)), DamageError) << index;
  }
  EXPECT_THROW(read(field_naming(0, {{0, 0}, {1, 1}})), DamageError);
}

}  // namespace
}  // namespace strata::registration
