// SPDX-License-Identifier: Apache-2.0
#include "tools/site/map_diff.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace strata::site {
namespace {

using testing::ElementsAre;

constexpr double kResolution_m = 0.05;

/// A free room, each cell seen `looks` times.
DiffSide room(double looks = 50.0) {
  const CellRect rect{{0, 0}, {100, 80}};
  DiffSide side{ReflectionGrid(kResolution_m, rect, 0.0F), {}, {}};
  side.counts = Grid<CellCounts>(kResolution_m, rect, {0.0, looks});
  return side;
}

void put(DiffSide& side, int x, int y, int width, int height, float reflection = 1.0F) {
  for (int j = y; j < y + height; ++j) {
    for (int i = x; i < x + width; ++i) side.map.at({i, j}) = reflection;
  }
}

std::vector<std::string> kinds(const MapDiff& diff) {
  std::vector<std::string> all;
  for (const MapChange& change : diff.changes) all.emplace_back(name_of(change.kind));
  return all;
}

TEST(MapDiff, TellsWhatCameAndWhatWent) {
  DiffSide before = room();
  DiffSide after = room();
  put(before, 10, 10, 8, 4);
  put(after, 80, 60, 20, 10);
  const MapDiff diff = map_diff(before, after);
  ASSERT_THAT(kinds(diff), ElementsAre("came", "went"));
  EXPECT_NEAR(diff.changes[0].area_m2, 20 * 10 * 0.0025, 1e-9);
  EXPECT_NEAR(diff.changes[0].center_m.x(), 90 * kResolution_m, 1e-9);
  EXPECT_GT(diff.changes[0].confidence, 0.95);
  EXPECT_NEAR(diff.changes[1].area_m2, 8 * 4 * 0.0025, 1e-9);
}

TEST(MapDiff, KnowsAThingThatMovedByItsSize) {
  DiffSide before = room();
  DiffSide after = room();
  put(before, 10, 10, 8, 8);
  put(after, 40, 10, 8, 8);
  const MapDiff diff = map_diff(before, after);
  ASSERT_THAT(kinds(diff), ElementsAre("moved"));
  ASSERT_TRUE(diff.changes[0].from_m.has_value());
  EXPECT_NEAR((diff.changes[0].center_m - *diff.changes[0].from_m).x(), 1.5, 1e-9);
}

TEST(MapDiff, IsSilentAboutWallsThatAreACellAsideAndAboutSpecks) {
  DiffSide before = room();
  DiffSide after = room();
  put(before, 10, 10, 60, 1);
  put(after, 10, 11, 60, 1);
  put(after, 50, 50, 2, 2);
  EXPECT_TRUE(map_diff(before, after).changes.empty());
  EXPECT_TRUE(map_diff(after, after).changes.empty());
}

TEST(MapDiff, IsLessSureOfWhatWasSeldomSeen) {
  DiffSide after = room(1.0);
  put(after, 30, 30, 10, 10, 0.6F);
  const MapDiff diff = map_diff(room(1.0), after);
  ASSERT_EQ(diff.changes.size(), 1U);
  EXPECT_LT(diff.changes[0].confidence, 0.6);
}

TEST(MapDiff, TellsWhatWasExploredAndForgotten) {
  DiffSide before = room();
  put(before, 0, 0, 40, 80, kUnknownReflection);
  EXPECT_THAT(kinds(map_diff(before, room())), ElementsAre("explored"));
  EXPECT_THAT(kinds(map_diff(room(), before)), ElementsAre("forgotten"));
}

TEST(MapDiff, TellsOfPlacesThatBeganOrCeasedToChange) {
  DiffSide after = room();
  patch::Submap door;
  door.rect = {{20, 20}, {30, 40}};
  after.submaps.push_back(door);
  EXPECT_THAT(kinds(map_diff(room(), after)), ElementsAre("place_came"));
  EXPECT_THAT(kinds(map_diff(after, room())), ElementsAre("place_went"));
}

TEST(MapDiff, IsGeoJsonThatIsClosedAndInMetres) {
  DiffSide after = room();
  put(after, 20, 40, 10, 10);
  const nlohmann::json geojson = to_geojson(map_diff(room(), after), "hall");
  EXPECT_EQ(geojson["type"], "FeatureCollection");
  EXPECT_EQ(geojson["frame"], "hall");
  ASSERT_EQ(geojson["features"].size(), 1U);
  const nlohmann::json& ring = geojson["features"][0]["geometry"]["coordinates"][0][0];
  ASSERT_EQ(ring.size(), 5U);
  EXPECT_EQ(ring[0], ring[4]);
  double area = 0.0;
  for (std::size_t i = 0; i + 1 < ring.size(); ++i) {
    area += ring[i][0].get<double>() * ring[i + 1][1].get<double>() -
            ring[i + 1][0].get<double>() * ring[i][1].get<double>();
  }
  EXPECT_NEAR(area / 2.0, 0.25, 1e-9) << "counterclockwise, as RFC 7946 has it";
  EXPECT_EQ(geojson["features"][0]["properties"]["kind"], "came");
}

}  // namespace
}  // namespace strata::site
