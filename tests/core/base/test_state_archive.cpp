// SPDX-License-Identifier: Apache-2.0
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/state_archive.hpp"

namespace strata {
namespace {

TEST(StateArchive, TakesNothingButZeroAndOneForABool) {
  StateWriter writer;
  writer(true);
  writer(std::optional<int>(7));
  std::vector<std::uint8_t> bytes = writer.take();
  bool value = false;
  std::optional<int> number;
  StateReader reader(bytes, "state");
  reader(value);
  reader(number);
  EXPECT_TRUE(value);
  EXPECT_EQ(number, 7);
  bytes[0] = 154;
  EXPECT_THROW(StateReader(bytes, "state")(value), InputError);
  bytes[1] = 2;
  EXPECT_THROW(StateReader(std::span(bytes).subspan(1), "state")(number), InputError);
}

}  // namespace
}  // namespace strata
