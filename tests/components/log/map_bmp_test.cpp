// SPDX-License-Identifier: Apache-2.0
/// Maps of map_server drawn as BMP.
#include "components/log/map_bmp.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/log/map_file.hpp"
#include "core/base/error.hpp"
#include "tests/components/log/log_fixture.hpp"
#include "tests/support/test_data.hpp"

namespace strata::log {
namespace {

using test_log::write_text;
using ::testing::HasSubstr;

std::string little(std::uint32_t value, int bytes) {
  std::string text;
  for (int i = 0; i < bytes; ++i) text += static_cast<char>((value >> (8 * i)) & 0xFFU);
  return text;
}

struct Drawing {
  std::uint32_t header_size = 40;
  std::int32_t width = 0;
  std::int32_t height = 0;
  std::uint32_t bits = 0;
  std::uint32_t compression = 0;
  std::uint32_t colours = 0;
  std::string rest = {};  ///< of the header, and the palette
  std::string pixels = {};

  [[nodiscard]] std::string bytes() const {
    std::string header = little(header_size, 4) + little(static_cast<std::uint32_t>(width), 4) +
                         little(static_cast<std::uint32_t>(height), 4) + little(1, 2) +
                         little(bits, 2) + little(compression, 4) + little(0, 4) + little(2835, 4) +
                         little(2835, 4) + little(colours, 4) + little(0, 4) + rest;
    const auto pixels_at = static_cast<std::uint32_t>(14 + header.size());
    const auto size = static_cast<std::uint32_t>(pixels_at + pixels.size());
    return "BM" + little(size, 4) + little(0, 4) + little(pixels_at, 4) + header + pixels;
  }
};

std::string grey(int value) { return std::string(3, static_cast<char>(value)); }

// Three cells by two, as a map: top row free, unknown, occupied; bottom row occupied, free, free.
constexpr int kGreys[2][3] = {{254, 205, 0}, {0, 254, 254}};

/// The rows, each filled up to four bytes.
std::string rows_of_24_bits(bool top_first) {
  std::string pixels = {};
  for (const int row : top_first ? std::vector{0, 1} : std::vector{1, 0}) {
    for (const int value : kGreys[row]) pixels += grey(value);
    pixels += std::string(3, '\x7f');
  }
  return pixels;
}

Drawing of_24_bits() {
  return {.width = 3, .height = 2, .bits = 24, .pixels = rows_of_24_bits(false)};
}

std::string palette(const std::vector<int>& greys) {
  std::string text;
  for (const int value : greys) text += grey(value) + '\0';
  return text;
}

std::string masks(std::uint32_t red, std::uint32_t green, std::uint32_t blue,
                  std::uint32_t opacity) {
  return little(red, 4) + little(green, 4) + little(blue, 4) + little(opacity, 4);
}

std::vector<std::pair<std::string, Drawing>> drawings_of_the_map() {
  std::string rgbx;
  for (const int row : {1, 0}) {
    for (const int value : kGreys[row]) rgbx += grey(value) + '\0';
  }
  return {
      {"24 bits", of_24_bits()},
      {"24 bits, top row first",
       {.width = 3, .height = -2, .bits = 24, .pixels = rows_of_24_bits(true)}},
      {"8 bits",
       {.width = 3,
        .height = 2,
        .bits = 8,
        .colours = 3,
        .rest = palette({0, 205, 254}),
        .pixels = std::string("\0\2\2\0\2\1\0\0", 8)}},
      {"4 bits",
       {.width = 3,
        .height = 2,
        .bits = 4,
        .colours = 3,
        .rest = palette({0, 205, 254}),
        .pixels = std::string("\x02\x20\0\0\x21\x00\0\0", 8)}},
      {"32 bits, the fourth byte unused", {.width = 3, .height = 2, .bits = 32, .pixels = rgbx}},
  };
}

class MapBmp : public testing::Test {
 protected:
  MapBmp() {
    write_text(yaml(),
               "image: m.bmp\nresolution: 0.1\norigin: [0, 0, 0]\n"
               "occupied_thresh: 0.65\nfree_thresh: 0.19\n");
  }
  [[nodiscard]] std::filesystem::path yaml() const { return folder_.path() / "m.yaml"; }
  [[nodiscard]] ReflectionGrid read(const std::string& image) const {
    write_text(folder_.path() / "m.bmp", image);
    return read_map(yaml());
  }
  void expect_refused(const Drawing& drawing, const std::string& why) const {
    try {
      (void)read(drawing.bytes());
      FAIL() << "was read: " << why;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(why));
      EXPECT_THAT(error.what(), HasSubstr("m.bmp"));
    }
  }
  strata::test::TemporaryDirectory folder_;
};

TEST_F(MapBmp, IsReadAtEveryDepth) {
  for (const auto& [name, drawing] : drawings_of_the_map()) {
    SCOPED_TRACE(name);
    const ReflectionGrid grid = read(drawing.bytes());
    EXPECT_EQ(grid.rect().width(), 3);
    EXPECT_EQ(grid.rect().height(), 2);
    EXPECT_EQ(grid.get({0, 1}), 0.0F);
    EXPECT_TRUE(std::isnan(grid.get({1, 1})));
    EXPECT_EQ(grid.get({2, 1}), 1.0F);
    EXPECT_EQ(grid.get({0, 0}), 1.0F);
    EXPECT_EQ(grid.get({1, 0}), 0.0F);
    EXPECT_EQ(grid.get({2, 0}), 0.0F);
  }
}

TEST_F(MapBmp, OfOneBitHasItsLeftmostPixelHighest) {
  const ReflectionGrid grid = read(Drawing{.width = 9,
                                           .height = 1,
                                           .bits = 1,
                                           .rest = palette({0, 255}),
                                           .pixels = std::string("\x40\x80\0\0", 4)}
                                       .bytes());
  for (int x = 0; x < 9; ++x) EXPECT_EQ(grid.get({x, 0}), x == 1 || x == 8 ? 0.0F : 1.0F) << x;
}

// In mode scale what is not opaque is unknown.
TEST_F(MapBmp, OpacityIsReadWhereTheHeaderNamesIt) {
  write_text(yaml(), "image: m.bmp\nmode: scale\nresolution: 0.1\norigin: [0, 0, 0]\n");
  const Drawing last{
      .header_size = 124,
      .width = 2,
      .height = 1,
      .bits = 32,
      .compression = 3,
      .rest = masks(0xFF0000U, 0xFF00U, 0xFFU, 0xFF000000U) + std::string(124 - 40 - 16, '\0'),
      .pixels = grey(0) + '\xff' + grey(0) + '\x10'};
  const Drawing first{
      .header_size = 108,
      .width = 2,
      .height = 1,
      .bits = 32,
      .compression = 3,
      .rest = masks(0xFF000000U, 0xFF0000U, 0xFF00U, 0xFFU) + std::string(108 - 40 - 16, '\0'),
      .pixels = '\xff' + grey(0) + '\x10' + grey(0)};
  for (const Drawing& drawing : {last, first}) {
    const ReflectionGrid grid = read(drawing.bytes());
    EXPECT_EQ(grid.get({0, 0}), 1.0F);
    EXPECT_TRUE(std::isnan(grid.get({1, 0})));
  }
}

TEST_F(MapBmp, ThatPromisesMoreThanItHasIsRefused) {
  Drawing drawing = of_24_bits();
  drawing.height = 50'000;
  drawing.width = 50'000;
  expect_refused(drawing, "is cut");
  drawing.width = 50'001;
  expect_refused(drawing, "has a damaged header");
  for (const std::int32_t width : {0, -3, std::numeric_limits<std::int32_t>::min()}) {
    drawing.width = width;
    expect_refused(drawing, "has a damaged header");
  }
  drawing = of_24_bits();
  for (const std::int32_t height : {0, std::numeric_limits<std::int32_t>::min()}) {
    drawing.height = height;
    expect_refused(drawing, "has a damaged header");
  }
}

TEST_F(MapBmp, OfAKindThatIsNotReadIsNamed) {
  Drawing drawing = of_24_bits();
  drawing.compression = 1;
  expect_refused(drawing, "is a compressed BMP");
  drawing = of_24_bits();
  drawing.bits = 16;
  expect_refused(drawing, "another number of bits a pixel");
  drawing = of_24_bits();
  drawing.header_size = 12;
  expect_refused(drawing, "of a kind that is not read here");
  drawing = {.width = 1,
             .height = 1,
             .bits = 8,
             .colours = 2,
             .rest = palette({0, 254}),
             .pixels = std::string("\2\0\0\0", 4)};
  expect_refused(drawing, "of a colour that its palette lacks");
  drawing = {.width = 1,
             .height = 1,
             .bits = 32,
             .compression = 3,
             .rest = little(0x3FF00000U, 4) + little(0xFFC00U, 4) + little(0x3FFU, 4),
             .pixels = std::string(4, '\0')};
  expect_refused(drawing, "channels of other than 8 bits");
}

TEST_F(MapBmp, CutAnywhereIsRefusedAndDamagedAnywhereEndsNothing) {
  std::mt19937 random(7);
  for (const auto& [name, drawing] : drawings_of_the_map()) {
    SCOPED_TRACE(name);
    const std::string whole = drawing.bytes();
    for (std::size_t size = 0; size < whole.size(); ++size) {
      EXPECT_THROW((void)read(whole.substr(0, size)), InputError) << size;
    }
    int refused = 0;
    for (int i = 0; i < 200; ++i) {
      std::string damaged = whole;
      for (int times = 0; times < 3; ++times) {
        damaged[random() % std::min<std::size_t>(damaged.size(), 70)] =
            static_cast<char>(random() % 256U);
      }
      try {
        EXPECT_GT(read(damaged).size(), 0U);
      } catch (const InputError&) {
        ++refused;
      }
    }
    EXPECT_GT(refused, 0);
  }
}

}  // namespace
}  // namespace strata::log
