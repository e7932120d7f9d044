// SPDX-License-Identifier: Apache-2.0
// A component reads its settings anew whenever a parameter is tried out, for years.
#include <cstddef>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <malloc.h>

#include "components/settings/settings.hpp"

namespace strata::settings {
namespace {

struct RoomConfig {
  int doors = 1;
  double width_m = 3.0;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("doors", c.doors, {.doc = "", .preset = {"hall", "4"}});
    v.renamed("exits", "doors");
    v.field("width_m", c.width_m, {.doc = "", .min = 1.0});
  }
};

struct HouseConfig {
  RoomConfig kitchen;
  std::vector<RoomConfig> rooms;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.group("kitchen", c.kitchen, "");
    v.list("rooms", c.rooms, "");
  }
};

/// Bytes that stay in use for each time that a document is read.
double kept_bytes(const std::string& text) {
  constexpr int kTimes = 500;
  const YAML::Node document = parse_yaml(text, "house.yaml");
  const auto read = [&] { (void)read_config<HouseConfig>(document, "house.yaml"); };
  for (int i = 0; i < 10; ++i) read();
  const std::size_t before = mallinfo2().uordblks;
  for (int i = 0; i < kTimes; ++i) read();
  return (static_cast<double>(mallinfo2().uordblks) - static_cast<double>(before)) / kTimes;
}

TEST(ReadingAgain, KeepsNothingOfADocumentWithPresentKeys) {
  EXPECT_LT(kept_bytes("kitchen: {doors: 2}\nrooms: [{doors: 1}, {width_m: 4.0}]"), 16.0);
}

TEST(ReadingAgain, KeepsNothingOfADocumentWithOldKeys) {
  EXPECT_LT(kept_bytes("kitchen: {exits: 2}\nrooms: [{exits: 1}, {width_m: 4.0}]"), 16.0);
}

TEST(ReadingAgain, KeepsNothingOfADocumentWithAPreset) {
  EXPECT_LT(kept_bytes("preset: hall\nkitchen: {width_m: 2.0}"), 16.0);
}

}  // namespace
}  // namespace strata::settings
