// SPDX-License-Identifier: Apache-2.0
#include "components/site/zone_masks.hpp"

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/log/map_file.hpp"
#include "core/base/error.hpp"
#include "core/random/stream.hpp"
#include "tests/support/nav2_costmap.hpp"
#include "tests/support/test_data.hpp"

namespace strata::site {
namespace {

using Document = Zones::Document;

/// Cells of 1 m, one zone a rectangle of them.
Document rectangle(const CellRect& rect, Document properties) {
  const Cell a = rect.min;
  const Cell b = rect.max;
  const CellPolygon polygon{{a, {b.x, a.y}, b, {a.x, b.y}}, {}};
  return to_feature({to_metric(polygon, 1.0)}, std::move(properties));
}
Zones zones_with(const Document& features) {
  return zones_of(to_collection(features, "map"), "zones");
}
const CellRect kRect{{0, 0}, {12, 1}};
ReflectionGrid floor_of(double resolution_m = 1.0, const CellRect& rect = kRect) {
  return {resolution_m, rect, 0.0F};
}
std::vector<int> values_of(const ZoneMask& mask) {
  std::vector<int> values;
  for (const float value : mask.values.values()) {
    values.push_back(is_known(value) ? static_cast<int>(std::lround(100.0F * value)) : -1);
  }
  return values;
}

TEST(ZoneMasks, ZonesNarrowerThanACellAreNamed) {
  const auto lane = [](double begin_m, double end_m, const char* name) {
    const MetricPolygon polygon{{{1.0, begin_m}, {5.0, begin_m}, {5.0, end_m}, {1.0, end_m}}, {}};
    return to_feature({polygon}, {{"name", name}, {"kind", "keepout"}});
  };
  const Zones zones = zones_with(
      Document::array({lane(0.4, 0.6, "over the middles"), lane(0.51, 0.9, "beside them"),
                       lane(3.4, 3.6, "beyond the cells")}));
  const std::string line = narrow_zones(zones, 1.0, kRect);
  EXPECT_THAT(line, testing::HasSubstr("'beside them', 'beyond the cells'"));
  EXPECT_THAT(line, testing::Not(testing::HasSubstr("over the middles")));
  EXPECT_EQ(narrow_zones(zones, 0.1, {{0, 0}, {60, 60}}), "");
}

TEST(ZoneMasks, MeanToNav2WhatTheZonesSay) {
  const Zones zones = zones_with(Document::array(
      {rectangle({{1, 0}, {3, 1}}, {{"name", "a"}, {"kind", "keepout"}}),
       rectangle({{2, 0}, {5, 1}}, {{"name", "b"}, {"kind", "keepout"}, {"cost_percent", 40}}),
       rectangle({{0, 0}, {4, 1}}, {{"name", "c"}, {"kind", "speed"}, {"speed_percent", 30.5}}),
       rectangle({{3, 0}, {6, 1}}, {{"name", "d"}, {"kind", "speed"}, {"speed_percent", 80}}),
       rectangle({{0, 0}, {2, 1}}, {{"name", "e"}, {"kind", "speed"}, {"speed_m_s", 1.5}}),
       rectangle({{1, 0}, {3, 1}}, {{"name", "f"}, {"kind", "speed"}, {"speed_m_s", 0.29}}),
       rectangle({{2, 0}, {4, 1}}, {{"name", "g"}, {"kind", "preferred"}})}));
  ReflectionGrid map = floor_of();
  map.at({3, 0}) = kUnknownReflection;
  map.at({11, 0}) = kUnknownReflection;
  const auto mask = [&](MaskKind kind) { return mask_of(zones, kind, map, kRect); };
  EXPECT_EQ(values_of(mask(MaskKind::kKeepout)),
            (std::vector<int>{-1, 100, 100, 40, 40, -1, -1, -1, -1, -1, -1, -1}));
  EXPECT_EQ(mask(MaskKind::kKeepout).meaning, (FilterMeaning{0, 0.0F, 1.0F}));
  EXPECT_EQ(values_of(mask(MaskKind::kPreferred)),
            (std::vector<int>{30, 30, 0, -1, 30, 30, 30, 30, 30, 30, 30, -1}))
      << "what is unknown stays so";
  const ZoneMask percent = mask(MaskKind::kSpeedPercent);
  EXPECT_EQ(values_of(percent), (std::vector<int>{70, 70, 70, 70, 20, 20, 0, 0, 0, 0, 0, 0}));
  const auto limit = [&](std::size_t cell) {
    return test::nav2::speed_limit(static_cast<std::int8_t>(values_of(percent)[cell]),
                                   percent.meaning.base, percent.meaning.multiplier);
  };
  EXPECT_EQ(percent.meaning.type, 1);
  EXPECT_EQ(limit(0), 30.0) << "rounded down";
  EXPECT_EQ(limit(4), 80.0);
  EXPECT_EQ(limit(8), 0.0) << "no limit";
  const ZoneMask metres = mask(MaskKind::kSpeedMetres);
  EXPECT_EQ(metres.meaning.type, 2);
  EXPECT_FLOAT_EQ(metres.meaning.multiplier, 0.02F);
  EXPECT_EQ(values_of(metres), (std::vector<int>{75, 14, 14, 0, 0, 0, 0, 0, 0, 0, 0, 0}));
  const auto nothing = values_of(mask_of(no_zones(), MaskKind::kPreferred, map, kRect));
  EXPECT_EQ(nothing, std::vector<int>(12, -1)) << "without a preferred zone nothing costs";
}

TEST(ZoneMasks, LetTheSmallestZoneSayWhatIsLearnedWhateverTheOrder) {
  const std::vector<Document> drawn{
      rectangle({{0, 0}, {9, 1}}, {{"name", "a"}, {"kind", "learn"}, {"control", "never_learn"}}),
      rectangle({{2, 0}, {7, 1}}, {{"name", "b"}, {"kind", "learn"}, {"control", "learn"}}),
      rectangle({{4, 0}, {6, 1}}, {{"name", "c"}, {"kind", "learn"}, {"control", "static_only"}}),
      rectangle({{5, 0}, {7, 1}}, {{"name", "d"}, {"kind", "learn"}, {"control", "never_learn"}})};
  const std::vector<std::uint8_t> expected{2, 2, 0, 0, 1, 2, 2, 2, 2, 0, 0, 0};
  const Zones one = zones_with(Document(drawn));
  const Zones other = zones_with(Document(std::vector<Document>(drawn.rbegin(), drawn.rend())));
  for (const Zones& zones : {one, other}) {
    EXPECT_EQ(learn_control(zones, 1.0, kRect).values(), expected);
    const ZoneMask never = mask_of(zones, MaskKind::kNeverLearn, floor_of(), kRect);
    EXPECT_EQ(never.meaning, (FilterMeaning{3, 0.0F, 1.0F}));
    EXPECT_EQ(values_of(never), (std::vector<int>{100, 100, 0, 0, 0, 100, 100, 100, 100, 0, 0, 0}));
    EXPECT_EQ(values_of(mask_of(zones, MaskKind::kStaticOnly, floor_of(), kRect))[4], 100);
  }
}

/// A mask of random values, written as nav2 reads it, read, made zones, written as text, and made
/// a mask of again.
TEST(ZoneMasks, GiveEveryCellOfARandomMaskBack) {
  const test::TemporaryDirectory folder;
  const std::vector<std::vector<float>> values{
      {kUnknownReflection, kUnknownReflection, 1.0F, 0.4F, 0.01F},  // keepout
      {0.3F, 0.3F, 0.0F},                                           // preferred
      {0.0F, 0.0F, 0.7F, 0.01F, 0.99F},                             // speed
      {0.0F, 0.0F, 0.29F, 1.0F, 0.01F},                             // speed_m_s
      {0.0F, 1.0F},                                                 // never_learn
      {0.0F, 0.0F, 1.0F}};                                          // static_only
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    RandomStream stream(seed, StreamId::kTest);
    const MaskKind kind = all_mask_kinds()[seed % all_mask_kinds().size()];
    const auto& possible = values[static_cast<std::size_t>(kind)];
    const double resolution_m = std::vector<double>{0.05, 0.1, 0.03}[(seed / 7) % 3];
    const Cell corner{static_cast<int>(stream.uniform() * 900.0) - 450,
                      static_cast<int>(stream.uniform() * 900.0) - 450};
    const CellRect rect{corner, {corner.x + 17, corner.y + 13}};
    ReflectionGrid mask(resolution_m, rect, 0.0F);
    for (float& value : mask.values()) {
      const double drawn = stream.uniform() * static_cast<double>(possible.size());
      value = possible[static_cast<std::size_t>(drawn)];
    }
    const std::filesystem::path yaml = folder.path() / "mask.yaml";
    log::write_map(yaml, mask, {.mode = log::MapMode::kRaw});
    const Zones made =
        zones_of_mask(log::read_map(yaml), kind, usual_meaning(kind), "zone", "map", "mask.yaml");
    const Zones zones = parse_zones(to_text(made), "again");
    const ZoneMask again = mask_of(zones, kind, floor_of(resolution_m, rect),
                                   mask_rect(zones, floor_of(resolution_m, rect)));
    EXPECT_EQ(again.values.rect(), rect) << seed;
    EXPECT_EQ(again.meaning, usual_meaning(kind)) << seed;
    EXPECT_EQ(values_of(again), values_of({mask, {}})) << name_of(kind) << ", seed " << seed;
  }
}

TEST(ZoneMasks, RefuseWhatNoMaskOrNoZoneCanHold) {
  const Zones apart = zones_with(Document::array(
      {rectangle({{0, 0}, {1, 1}}, {{"name", "a"}, {"kind", "speed"}, {"speed_m_s", 0.02}}),
       rectangle({{0, 0}, {1, 1}}, {{"name", "b"}, {"kind", "speed"}, {"speed_m_s", 5}})}));
  EXPECT_THROW((void)mask_of(apart, MaskKind::kSpeedMetres, floor_of(), kRect), InputError)
      << "a limit must not come out above what was asked for";
  const Zones far = zones_with(Document::array(
      {rectangle({{0, 0}, {1, 1}}, {{"name", "a"}, {"kind", "keepout"}}),
       rectangle({{9000, 9000}, {9001, 9001}}, {{"name", "b"}, {"kind", "keepout"}})}));
  EXPECT_THROW((void)mask_rect(far, floor_of()), InputError);
  const ReflectionGrid fast(1.0, kRect, 0.5F);
  EXPECT_THROW((void)zones_of_mask(fast, MaskKind::kSpeedMetres, {2, 0.0F, 1.0F}, "a", "map", "m"),
               InputError)
      << "50 m/s";
  EXPECT_THROW((void)mask_kind("sped"), InputError);
}

TEST(ZoneMasks, OfOneKindAreMadeWhateverIsWrongWithAnother) {
  const auto at = [](int x, Document properties) {
    return rectangle({{x, 0}, {x + 2, 1}}, std::move(properties));
  };
  const Zones zones = zones_with(
      Document::array({at(0, {{"name", "stairs"}, {"kind", "keepout"}}),
                       rectangle({{9000, 9000}, {9001, 9001}},
                                 {{"name", "far"}, {"kind", "speed"}, {"speed_percent", 30}}),
                       at(4, {{"name", "slow"}, {"kind", "speed"}, {"speed_m_s", 0.02}}),
                       at(8, {{"name", "fast"}, {"kind", "speed"}, {"speed_m_s", 5}})}));
  const ReflectionGrid map = floor_of();
  EXPECT_EQ(mask_rect(zones, map, MaskKind::kKeepout), kRect);
  EXPECT_EQ(values_of(mask_of(zones, MaskKind::kKeepout, map, kRect))[0], 100);
  EXPECT_THROW((void)mask_rect(zones, map, MaskKind::kSpeedPercent), InputError);
  EXPECT_THROW((void)mask_of(zones, MaskKind::kSpeedMetres, map, kRect), InputError);
  EXPECT_THROW(require_masks(zones, map), InputError);
  EXPECT_NO_THROW(require_masks(
      zones_with(Document::array(
          {rectangle({{9000, 9000}, {9001, 9001}},
                     {{"name", "far"}, {"kind", "learn"}, {"control", "static_only"}})})),
      map));
}

}  // namespace
}  // namespace strata::site
