// SPDX-License-Identifier: Apache-2.0
#include "components/site/zones.hpp"

#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/site/site.hpp"
#include "core/base/error.hpp"
#include "tests/support/test_data.hpp"

namespace strata::site {
namespace {

using Document = Zones::Document;
using testing::HasSubstr;

constexpr const char* kSquare = "[[[0, 0], [2, 0], [2, 2], [0, 2], [0, 0]]]";

std::string collection(const std::vector<std::string>& features) {
  std::string text = R"({"type": "FeatureCollection", "features": [)";
  for (std::size_t i = 0; i < features.size(); ++i) text += (i > 0 ? ",\n" : "\n") + features[i];
  return text + "\n]}";
}
std::string feature(const std::string& properties, const std::string& coordinates = kSquare,
                    const std::string& type = "Polygon") {
  return R"({"type": "Feature", "properties": {)" + properties + R"(}, "geometry": {"type": ")" +
         type + R"(", "coordinates": )" + coordinates + "}}";
}
const std::string kDock = R"("name": "dock", "kind": "keepout")";

std::string error_of(const std::string& text) {
  try {
    (void)parse_zones(text, "z.geojson");
  } catch (const InputError& error) {
    EXPECT_FALSE(error.remedy().empty());
    return error.what();
  }
  return "none";
}

TEST(Zones, AreReadOfEveryKind) {
  const Zones zones = parse_zones(
      collection({feature(R"("name": "a", "kind": "learn", "control": "static_only")"),
                  feature(R"("name": "b", "kind": "keepout", "cost_percent": 40)"),
                  feature(R"("name": "c", "kind": "speed", "speed_percent": 30)"),
                  feature(R"("name": "d", "kind": "speed", "speed_m_s": 0.4)"),
                  feature(R"("name": "e", "kind": "preferred")",
                          "[[[[0,0],[4,0],[4,4],[0,4],[0,0]],[[1,1],[1,2],[2,2],[2,1],[1,1]]],"
                          "[[[9,9,7.5],[10,9,7.5],[9,10,7.5],[9,9,7.5]]]]",
                          "MultiPolygon")}),
      "z.geojson");
  ASSERT_EQ(zones.zones.size(), 5U);
  EXPECT_EQ(zones.zones[0].control, LearnControl::kStaticOnly);
  EXPECT_EQ(zones.zones[1].cost_percent, 40.0);
  EXPECT_EQ(zones.zones[2].speed_percent, 30.0);
  EXPECT_EQ(zones.zones[3].speed_m_s, 0.4);
  EXPECT_EQ(zones.zones[4].kind, ZoneKind::kPreferred);
  EXPECT_EQ(zones.zones[4].shape.size(), 2U);
  EXPECT_NEAR(area_m2(zones.zones[4]), 15.5, 1e-9);
  EXPECT_EQ(zones.find("d"), &zones.zones[3]);
  EXPECT_EQ(zones.find("f"), nullptr);
}

TEST(Zones, OfLiftsNameTheLevelsThatTheyServe) {
  const Zones zones =
      parse_zones(collection({feature(R"("name": "a", "kind": "lift", "levels": ["0", "1"])"),
                              feature(R"("name": "b", "kind": "lift")"),
                              feature(R"("name": "c", "kind": "keepout", "levels": "theirs")")}),
                  "z.geojson");
  EXPECT_EQ(zones.zones[0].kind, ZoneKind::kLift);
  EXPECT_EQ(zones.zones[0].levels, (std::vector<std::string>{"0", "1"}));
  EXPECT_TRUE(zones.zones[1].levels.empty());
  EXPECT_TRUE(zones.zones[2].levels.empty());
  const std::string lift = R"("name": "a", "kind": "lift", )";
  EXPECT_THAT(error_of(collection({feature(lift + R"("levels": ["0"])")})), HasSubstr("two"));
  EXPECT_THAT(error_of(collection({feature(lift + R"("levels": [0, 1])")})), HasSubstr("no text"));
  EXPECT_THAT(error_of(collection({feature(lift + R"("level": ["0", "1"])")})),
              HasSubstr("did you mean 'levels'"));
}

TEST(Zones, SayWhereTheyAreWrongAndWhatToDo) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {"", "z.geojson:1: is no JSON"},
      {"{\n\"type\": NaN}", "z.geojson:2: is no JSON"},
      {collection({feature(kDock, "[[[0,0],[1e999,0],[1,1],[0,0]]]")}), "number that is too large"},
      {"[]", "is no FeatureCollection"},
      {collection({"{}"}), "feature 1: type: is no Feature"},
      {collection({feature(kDock), feature(R"("kind": "keepout")")}),
       "feature 2: properties.name: is missing"},
      {collection({feature(kDock), feature(kDock)}), "is \"dock\", as another zone's"},
      {collection({feature(R"("name": "", "kind": "keepout")")}), "properties.name: is empty"},
      {collection({feature(R"("name": "a", "kind": "keep_out")")}),
       "is \"keep_out\"; choose among learn, keepout, speed, preferred"},
      {collection({feature(R"("name": "a", "kind": "learn", "control": "never")")}),
       "choose among learn, never_learn, static_only"},
      {collection({feature(R"("name": "a", "kind": "speed")")}), "have no speed"},
      {collection({feature(R"("name": "a", "kind": "speed", "speed_percent": 0)")}),
       "properties.speed_percent: is 0; write a number from 1"},
      {collection({feature(R"("name": "a", "kind": "speed", "speed_m_s": "1")")}), "is no number"},
      {collection({feature(kDock + R"(, "speed_m_s": 1)")}), "is for zones of kind speed"},
      {collection({feature(R"("name": "a", "kind": "speed", "speed_pecent": 9)")}),
       "properties.speed_pecent: is unknown; did you mean 'speed_percent'?"},
      {collection({feature(kDock, "[[0, 0], [1, 1]]", "LineString")}),
       "geometry.type: is neither Polygon nor MultiPolygon"},
      {collection({feature(kDock, "[]")}), "geometry.coordinates: is empty"},
      {collection({feature(kDock, "[[]]", "MultiPolygon")}),
       "geometry.coordinates[0]: is an empty polygon"},
      {collection({feature(kDock, "[[[0,0],[2,0],[2,2],[0,2]]]")}),
       "geometry.coordinates[0]: does not end where it begins; repeat its first position"},
      {collection({feature(kDock, "[[[0,0],[2,0],[0,0]]]")}), "fewer than four positions"},
      {collection({feature(kDock, "[[[0,0],[1,1],[2,2],[0,0]]]")}), "holds no area"},
      {collection({feature(kDock, "[[[0,0],[2,null],[2,2],[0,0]]]")}),
       "feature 1: (\"dock\") geometry.coordinates[0][1]: is no position"},
      {collection({feature(kDock, "[[[0,0],[2e6,0],[2,2],[0,0]]]")}),
       "is further than 10 km from the origin"},
      {std::string(1000, '[') + std::string(1000, ']'), "is nested more than 32 deep"},
      {std::string(17'000'000, ' '), "is larger than 16 MB"},
  };
  for (const auto& [text, what] : cases) EXPECT_THAT(error_of(text), HasSubstr(what));
}

/// QGIS gives every feature a column of every property, writes polygons as MultiPolygons and adds
/// members of its own.
TEST(Zones, KeepWhatOtherProgramsWroteAndTheOrderOfIt) {
  const std::string text =
      R"({"type": "FeatureCollection", "name": "zones", "crs": {"type": "name"}, "features": [
{"type": "Feature", "id": 7, "properties": {"fid": 3, "name": "dock", "kind": "keepout",
"control": null, "cost_percent": null, "speed_m_s": null, "color": "#ff0000", "checked by": "Ada"}, "geometry":
{"type": "MultiPolygon", "coordinates": [[[[0, 0], [2, 0], [2, 2], [0, 0]]]]}}], "zoom": [1, 2]})";
  Zones zones = parse_zones(text, "z.geojson");
  const Document before = zones.document;
  add(zones, parse_zones(feature(R"("name": "a", "kind": "preferred", "a": {"b": [1]})"), "more"),
      "more");
  Zones again = parse_zones(to_text(zones), "again");
  ASSERT_EQ(again.zones.size(), 2U);
  EXPECT_EQ(again.document["features"][1]["properties"]["a"]["b"][0], 1);
  remove(again, "a", "z.geojson");
  EXPECT_EQ(again.document.dump(), before.dump()) << "the order of keys, too";
  remove(again, "dock", "z.geojson");
  EXPECT_EQ(again.document["zoom"][1], 2) << "also without a zone";
  EXPECT_THROW(remove(again, "dock", "z.geojson"), InputError);
  EXPECT_THROW(add(zones, zones, "z.geojson"), InputError) << "names are there already";
}

TEST(Zones, AreNoRegionsButRegionsAreReadOfAnyPolygons) {
  const std::string ring = "[[[0,0],[2,0],[2,1],[0,1],[0,0]]]";
  const std::string polygon = R"({"type": "Polygon", "coordinates": )" + ring + "}";
  const std::string feature =
      R"({"type": "Feature", "properties": {"kind": "came"}, "geometry": )" + polygon + "}";
  for (const std::string& text :
       {polygon, R"({"type": "MultiPolygon", "coordinates": [)" + ring + "]}", feature,
        R"({"type": "FeatureCollection", "features": [)" + feature + "]}"}) {
    const auto region = parse_region(text, "region");
    ASSERT_EQ(region.size(), 1U) << text;
    EXPECT_EQ(area_m2(region[0]), 2.0) << text;
  }
  const std::string twice =
      R"({"type": "FeatureCollection", "features": [)" + feature + "," + feature + "]}";
  EXPECT_EQ(parse_region(twice, "region").size(), 2U);
  EXPECT_THROW((void)parse_zones(twice, "zones"), InputError);
}

TEST(Zones, OfASiteAreChangedWholeOrNotAtAll) {
  const test::TemporaryDirectory folder;
  const Actor ada{"ada", 1};
  Site site = Site::create(folder.path() / "hall", "hall-3", "map", ada);
  EXPECT_TRUE(site.zones().zones.empty());
  const Zones more = parse_zones(collection({feature(kDock)}), "more");
  (void)site.change_zones([&](Zones& zones) { add(zones, more, "more"); }, ada, "added dock");
  EXPECT_EQ(Site(folder.path() / "hall").zones().zones.size(), 1U);
  EXPECT_EQ(site.decisions().diary.back().note, "added dock");
  const std::string before = test::bytes_of(site.zones_file());
  EXPECT_THROW((void)site.change_zones([&](Zones& zones) { add(zones, more, "more"); }, ada, ""),
               InputError);
  EXPECT_EQ(test::bytes_of(site.zones_file()), before);
  std::ofstream(site.zones_file()) << "{";
  EXPECT_THROW((void)site.zones(), InputError);
  (void)site.change_zones([&](Zones& zones) { zones = more; }, ada, "set", true);
  EXPECT_EQ(test::bytes_of(site.zones_file()), before) << "set mends a damaged file";
}

}  // namespace
}  // namespace strata::site
