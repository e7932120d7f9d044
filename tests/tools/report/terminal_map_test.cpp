// SPDX-License-Identifier: Apache-2.0
/// The small map of a terminal: what is drawn where, and which terminals get one.
#include "tools/report/terminal_map.hpp"

#include <cmath>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tools/report/terminal_shape.hpp"

namespace strata::report {
namespace {

const TerminalShape kPlain{.columns = 80, .rows = 20, .color = false};

/// Known and free but for the cells given.
ReflectionGrid map_of(const CellRect& rect, const std::vector<Cell>& occupied) {
  ReflectionGrid map(1.0, rect, 0.0F);
  for (const Cell& cell : occupied) map.at(cell) = 1.0F;
  return map;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

/// Characters of UTF-8, each one column wide; escape sequences are none.
std::size_t columns_of(const std::string& line) {
  std::size_t columns = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '\x1b') {
      i = line.find('m', i);
    } else if ((static_cast<unsigned char>(line[i]) & 0xc0U) != 0x80U) {
      ++columns;
    }
  }
  return columns;
}

TEST(TerminalMap, DrawsEachCellAsADotNorthUp) {
  // One character: 2 x 4 cells. The upper left, and the lower right.
  EXPECT_EQ(terminal_map(map_of({{0, 0}, {2, 4}}, {{0, 3}}), {}, kPlain),
            "\u2801\n2.0 m x 4.0 m\n");
  EXPECT_EQ(terminal_map(map_of({{0, 0}, {2, 4}}, {{1, 0}}), {}, kPlain),
            "\u2880\n2.0 m x 4.0 m\n");
  EXPECT_EQ(terminal_map(map_of({{-6, -2}, {-2, 2}}, {{-3, 1}, {-6, -2}}), {}, kPlain),
            "\u2840\u2808\n4.0 m x 4.0 m\n");
}

TEST(TerminalMap, KeepsThinWallsOfLargeMapsWithinItsShape) {
  ReflectionGrid map(0.05, CellRect{{0, 0}, {4000, 1000}}, 0.0F);
  for (int x = 0; x < 4000; ++x) map.at({x, 500}) = 0.3F;
  const auto lines = lines_of(terminal_map(map, {}, {.columns = 100, .rows = 20}));
  ASSERT_EQ(lines.size(), 14U) << "13 of the map, for 100 wide, and its size";
  for (const std::string& line : lines) EXPECT_LE(columns_of(line), 100U);
  std::size_t full = 0;
  for (const std::string& line : lines) full += columns_of(line) == 100U ? 1 : 0;
  EXPECT_EQ(full, 1U) << "the wall, whole";
  EXPECT_EQ(lines.back(), "200.0 m x 50.0 m");
  // A high one is limited by the rows.
  ReflectionGrid high(0.05, CellRect{{0, 0}, {100, 3000}}, 0.0F);
  EXPECT_EQ(lines_of(terminal_map(high, {}, {.columns = 100, .rows = 20})).size(), 21U);
}

TEST(TerminalMap, DrawsTheWayInColourOrInBullets) {
  const ReflectionGrid map = map_of({{0, 0}, {6, 4}}, {{0, 3}, {5, 3}});
  const std::vector<TerminalWay> ways{{Pose2{2.5, 0.5, 0.0}, Pose2{3.5, 0.5, 0.0}}};
  EXPECT_EQ(lines_of(terminal_map(map, ways, kPlain))[0], "\u2801\u2022\u2808");
  TerminalShape colored = kPlain;
  colored.color = true;
  EXPECT_EQ(lines_of(terminal_map(map, ways, colored))[0], "\u2801\x1b[35m\u28c0\x1b[0m\u2808");
}

TEST(TerminalMap, EndsEachLineWithoutColour) {
  const ReflectionGrid map = map_of({{0, 0}, {2, 4}}, {});
  const std::vector<TerminalWay> ways{{Pose2{0.5, 3.5, 0.0}}};
  EXPECT_EQ(terminal_map(map, ways, {.columns = 80, .rows = 20, .color = true}),
            "\x1b[35m\u2801\x1b[0m\n2.0 m x 4.0 m\n");
}

TEST(TerminalMap, JoinsTheWayAndBreaksItWhereTheRobotLeapt) {
  const ReflectionGrid map(0.1, CellRect{{0, 0}, {160, 4}}, 0.0F);
  const std::vector<TerminalWay> joined{{Pose2{0.05, 0.05, 0.0}, Pose2{1.95, 0.05, 0.0}}};
  EXPECT_EQ(columns_of(lines_of(terminal_map(map, joined, kPlain))[0]), 10U);
  EXPECT_EQ(lines_of(terminal_map(map, joined, kPlain))[0].find(' '), std::string::npos);
  const std::vector<TerminalWay> leapt{{Pose2{0.05, 0.05, 0.0}, Pose2{15.95, 0.05, 0.0}}};
  EXPECT_EQ(lines_of(terminal_map(map, leapt, kPlain))[0],
            "\u2022" + std::string(78, ' ') + "\u2022");
}

TEST(TerminalMap, ShowsAWayOutsideOfWhatIsKnownAndLeavesOutWhatIsNoNumber) {
  const ReflectionGrid map = map_of({{0, 0}, {2, 4}}, {{0, 3}});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<TerminalWay> ways{{Pose2{nan, 0.0, 0.0}, Pose2{9.5, 3.5, 0.0}}};
  EXPECT_EQ(terminal_map(map, ways, kPlain), "\u2801   \u2022\n10.0 m x 4.0 m\n");
}

TEST(TerminalMap, OfNothingIsNothing) {
  const ReflectionGrid unknown(1.0, CellRect{{0, 0}, {5, 5}}, kUnknownReflection);
  EXPECT_EQ(terminal_map(unknown, {}, kPlain), "");
  EXPECT_EQ(terminal_map(ReflectionGrid{}, {}, kPlain), "");
  EXPECT_EQ(terminal_map(map_of({{0, 0}, {2, 4}}, {}), {}, {.columns = 0, .rows = 20}), "");
}

TerminalFacts usual() {
  return {.is_terminal = true,
          .columns = 80,
          .lines = 50,
          .term = "xterm-256color",
          .locale = "en_US.UTF-8",
          .no_color = ""};
}

TEST(TerminalShape, FitsTheTerminalUpToAHundredColumns) {
  TerminalFacts facts = usual();
  ASSERT_TRUE(shape_for(facts));
  EXPECT_EQ(shape_for(facts)->columns, 80);
  EXPECT_EQ(shape_for(facts)->rows, 20);
  EXPECT_TRUE(shape_for(facts)->color);
  facts.columns = 300;
  facts.lines = 18;
  EXPECT_EQ(shape_for(facts)->columns, 100);
  EXPECT_EQ(shape_for(facts)->rows, 13) << "what is said stays in view";
  facts.columns = facts.lines = 0;
  EXPECT_EQ(shape_for(facts)->columns, 80);
  EXPECT_EQ(shape_for(facts)->rows, 20);
}

TEST(TerminalShape, IsNoneWhereNoBrailleCanBeShown) {
  const auto with = [](auto change) {
    TerminalFacts facts = usual();
    change(facts);
    return shape_for(facts);
  };
  EXPECT_FALSE(with([](auto& facts) { facts.is_terminal = false; }));
  for (const char* term : {"", "dumb", "linux"}) {
    EXPECT_FALSE(with([&](auto& facts) { facts.term = term; })) << term;
  }
  for (const char* locale : {"", "C", "de_DE.ISO-8859-1"}) {
    EXPECT_FALSE(with([&](auto& facts) { facts.locale = locale; })) << locale;
  }
  EXPECT_TRUE(with([](auto& facts) { facts.locale = "C.utf8"; }));
  EXPECT_FALSE(with([](auto& facts) { facts.columns = 19; }));
  EXPECT_FALSE(with([](auto& facts) { facts.lines = 8; }));
}

TEST(TerminalShape, HasNoColourWhereNoneIsWanted) {
  TerminalFacts facts = usual();
  facts.no_color = "1";
  ASSERT_TRUE(shape_for(facts));
  EXPECT_FALSE(shape_for(facts)->color);
}

}  // namespace
}  // namespace strata::report
