// SPDX-License-Identifier: Apache-2.0
#include "core/base/state_archive.hpp"

#include <optional>
#include <vector>

#include <gtest/gtest.h>

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

enum class Door : std::uint8_t { kOpen, kClosed };
constexpr Door last_enumerator(Door /*of*/) { return Door::kClosed; }

TEST(StateArchive, TakesNothingForAnEnumThatItDoesNotHave) {
  StateWriter writer;
  writer(Door::kClosed);
  writer(std::vector<Door>{Door::kOpen, Door::kClosed});
  std::vector<std::uint8_t> bytes = writer.take();
  const auto read = [&] {
    StateReader reader(bytes, "state");
    Door door = Door::kOpen;
    std::vector<Door> doors;
    reader(door);
    reader(doors);
    return doors;
  };
  EXPECT_EQ(read().back(), Door::kClosed);
  bytes.back() = 2;
  EXPECT_THROW((void)read(), DamageError);
  bytes.back() = 1;
  bytes.front() = 255;
  EXPECT_THROW((void)read(), DamageError);
}

/// With seven bytes at its end that are nobody's.
struct Gapped {
  double number = 0.5;
  bool flag = true;

  template <class Self, class Archive>
  static void state(Self& self, Archive& archive) {
    archive(self.number);
    archive(self.flag);
  }
};

TEST(StateArchive, OfAClassThatListsItsValuesHasNothingElse) {
  StateWriter writer;
  writer(Gapped{});
  writer(std::vector<Gapped>(3));
  const std::vector<std::uint8_t> bytes = writer.take();
  EXPECT_EQ(bytes.size(), 4 * (sizeof(double) + 1) + sizeof(std::uint64_t));
  Gapped one{0.0, false};
  std::vector<Gapped> more;
  StateReader reader(bytes, "state");
  reader(one);
  reader(more);
  EXPECT_NO_THROW(reader.expect_end());
  EXPECT_EQ(one.number, 0.5);
  EXPECT_TRUE(one.flag);
  ASSERT_EQ(more.size(), 3U);
  EXPECT_TRUE(more.back().flag);
}

TEST(StateArchive, FindsAByteThatIsNoBoolInSuchAClass) {
  StateWriter writer;
  writer(std::vector<Gapped>(2));
  std::vector<std::uint8_t> bytes = writer.take();
  std::vector<Gapped> read;
  EXPECT_NO_THROW(StateReader(bytes, "state")(read));
  bytes.back() = 77;
  EXPECT_THROW(StateReader(bytes, "state")(read), DamageError);
}

}  // namespace
}  // namespace strata
