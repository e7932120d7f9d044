// SPDX-License-Identifier: Apache-2.0
#include "components/log/map_file.hpp"

#include <cmath>
#include <limits>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "tests/components/log/log_fixture.hpp"
#include "tests/support/test_data.hpp"

namespace strata::log {
namespace {

using test::bytes_of;
using test_log::write_text;

TEST(MapFile, AMapReadsBackCellByCell) {
  const strata::test::TemporaryDirectory folder;
  ReflectionGrid grid = make_reflection_grid(0.05, {{-7, 3}, {5, 9}});
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (i % 3 != 0) grid.values()[i] = i % 3 == 1 ? 0.0F : 1.0F;
  }
  write_map(folder.path() / "m.yaml", grid);
  const ReflectionGrid back = read_map(folder.path() / "m.yaml");
  EXPECT_DOUBLE_EQ(back.resolution_m(), 0.05);
  for (int y = 0; y < 12; ++y) {
    for (int x = -10; x < 8; ++x) {
      const float a = grid.get({x, y});
      const float b = back.get({x, y});
      EXPECT_TRUE(a == b || (std::isnan(a) && std::isnan(b))) << x << " " << y;
    }
  }
}

TEST(MapFile, ThresholdsThatLeaveNothingBetweenThemAreRefused) {
  const strata::test::TemporaryDirectory folder;
  write_map(folder.path() / "m.yaml", make_reflection_grid(0.05, {{0, 0}, {2, 2}}));
  const auto read_with = [&](const std::string& thresholds) {
    write_text(folder.path() / "t.yaml",
               "image: m.pgm\nresolution: 0.05\norigin: [0, 0, 0]\n" + thresholds);
    (void)read_map(folder.path() / "t.yaml");
  };
  EXPECT_NO_THROW(read_with("free_thresh: 0.3\noccupied_thresh: 0.3\n"));
  for (const char* thresholds :
       {"free_thresh: 0.65\noccupied_thresh: 0.25\n", "free_thresh: .nan\n",
        "occupied_thresh: 1.5\n", "free_thresh: -0.1\n"}) {
    EXPECT_THROW(read_with(thresholds), InputError) << thresholds;
  }
}

TEST(MapFile, AMissingImageIsNamed) {
  const strata::test::TemporaryDirectory folder;
  write_text(folder.path() / "m.yaml", "image: gone.pgm\nresolution: 0.1\norigin: [0, 0, 0]\n");
  try {
    (void)read_map(folder.path() / "m.yaml");
    FAIL() << "a map without image was read";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("gone.pgm"));
    EXPECT_THAT(error.what(), ::testing::HasSubstr("missing"));
  }
}

TEST(MapFile, DamagedMapsAreRefused) {
  const strata::test::TemporaryDirectory folder;
  const auto yaml = folder.path() / "m.yaml";
  const auto refuses = [&](const std::string& text, const std::string& image) {
    write_text(yaml, text);
    write_text(folder.path() / "m.pgm", image);
    EXPECT_THROW((void)read_map(yaml), InputError) << text << image;
  };
  const std::string good = "image: m.pgm\nresolution: 0.1\norigin: [0, 0, 0]\n";
  const std::string image = "P5\n2 2\n255\n\x01\x02\x03\x04";
  write_text(yaml, good);
  write_text(folder.path() / "m.pgm", image);
  EXPECT_NO_THROW((void)read_map(yaml));
  refuses("image: m.pgm\n", image);
  refuses("image: [\n", image);
  refuses("image: m.pgm\nresolution: -1\norigin: [0, 0, 0]\n", image);
  refuses("image: m.pgm\nresolution: 0.1\norigin: [0, 0, 1]\n", image);
  refuses(good + "mode: heap\n", image);
  refuses(good, "P5\n2 2\n255\n\x01");
  refuses(good, "P5\n40000 40000\n255\n\x01");
  refuses(good, "P6\n2 2\n255\n");
  refuses(good, "");
  refuses(good, "\x89PNG\r\n\x1a\nand no more");
}

/// Known, free, between and unknown cells, without an empty border, which writing cuts off.
ReflectionGrid percents() {
  ReflectionGrid grid = make_reflection_grid(0.05, {{-2, 3}, {2, 5}});
  const float kUnknown = std::numeric_limits<float>::quiet_NaN();
  grid.values() = {0.0F, 1.0F, 0.37F, kUnknown, 0.5F, 0.01F, 0.99F, 0.25F};
  return grid;
}

TEST(MapFile, ReadsBackWhatItWroteInEveryModeAndFormat) {
  const strata::test::TemporaryDirectory folder;
  const auto yaml = folder.path() / "m.yaml";
  const ReflectionGrid grid = percents();
  for (const MapImageFormat image : {MapImageFormat::kPgm, MapImageFormat::kPng}) {
    for (const MapMode mode : {MapMode::kTrinary, MapMode::kScale, MapMode::kRaw}) {
      if (mode == MapMode::kScale && image == MapImageFormat::kPgm) continue;
      // Thresholds that a scale begins and ends at.
      write_map(yaml, grid, {image, mode, mode == MapMode::kScale ? 1.0 : 0.65, 0.0});
      const bool is_png = image == MapImageFormat::kPng;
      EXPECT_THAT(bytes_of(yaml), ::testing::HasSubstr(is_png ? "m.png" : "m.pgm"));
      if (mode == MapMode::kTrinary) write_map(yaml, grid, {image, mode});
      const ReflectionGrid back = read_map(yaml);
      ASSERT_EQ(back.rect(), grid.rect());
      for (std::size_t i = 0; i < grid.size(); ++i) {
        const float value = grid.values()[i];
        const float expected = mode != MapMode::kTrinary ? value
                               : is_occupied(value)      ? 1.0F
                               : is_free(value)          ? 0.0F
                                                         : std::nanf("");
        const float got = back.values()[i];
        EXPECT_EQ(is_known(got), is_known(expected)) << i;
        if (!is_known(expected)) continue;
        EXPECT_NEAR(got, expected, mode == MapMode::kRaw ? 1e-6 : 0.003);
      }
    }
  }
}

TEST(MapFile, KeepsTheUnknownUnknownBetweenAnyThresholds) {
  const strata::test::TemporaryDirectory folder;
  const auto yaml = folder.path() / "m.yaml";
  ReflectionGrid grid = make_reflection_grid(0.05, {{0, 0}, {3, 1}});
  grid.values() = {1.0F, std::nanf(""), 0.0F};
  for (const auto& [free, occupied] :
       {std::pair{0.25, 0.65}, {0.19, 0.65}, {0.6, 0.61}, {0.01, 0.1}}) {
    write_map(yaml, grid, {.occupied = occupied, .free = free});
    const ReflectionGrid back = read_map(yaml);
    ASSERT_EQ(back.size(), 3U);
    EXPECT_EQ(back.values()[0], 1.0F) << free;
    EXPECT_FALSE(is_known(back.values()[1])) << free;
    EXPECT_EQ(back.values()[2], 0.0F) << free;
  }
  EXPECT_THROW(write_map(yaml, grid, {.occupied = 0.5001, .free = 0.5}), InputError);
  EXPECT_THROW(write_map(yaml, grid, {.mode = MapMode::kScale}), InputError) << "as pgm";
}

TEST(MapFile, RealMapsRead) {
  STRATA_REQUIRE_DATA(wean, "wean_hall/wean_map.yaml");
  const ReflectionGrid grid = read_map(wean);
  EXPECT_EQ(grid.width(), 800);
  EXPECT_EQ(grid.height(), 800);
  EXPECT_DOUBLE_EQ(grid.resolution_m(), 0.1);
  STRATA_REQUIRE_DATA(olin, "olin_mac/mac_1st_floor_9_23.yaml");
  const ReflectionGrid other = read_map(olin);
  EXPECT_EQ(other.width(), 530);
  EXPECT_NEAR(other.rect().min.y * 0.03, -27.9, 0.016);
}

}  // namespace
}  // namespace strata::log
