// SPDX-License-Identifier: Apache-2.0
/// One region of a version, or of new logs: `strata site merge` and `strata learn --only-in`.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "components/maps/earlier_runs.hpp"
#include "components/maps/maps_folder.hpp"
#include "tests/support/test_data.hpp"
#include "tests/tools/strata/program.hpp"

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

using nlohmann::json;
using test::quoted;
using testing::HasSubstr;
using testing::Not;

/// A hall with three doors, closed on the first day and open on the second. The first version is of
/// the first day, the second of both.
class SiteMerge : public testing::Test {
 protected:
  void SetUp() override {
    run("simulate '" STRATA_SOURCE_DIR
        "/tools/simulate/scenarios/three_doors.yaml' --set days=2 --seed 101 --per-day --out " +
        quoted(at("days")));
    learn(1, "--out " + quoted(at("one")));
    learn(2, "--update " + quoted(at("one")) + " --out " + quoted(at("two")));
    run("site init " + quoted(at("site")) + " --id hall");
    run("site add " + quoted(at("site")) + " " + quoted(at("one")));
    run("site approve " + quoted(at("site")) + " 1 --unchecked");
    run("site activate " + quoted(at("site")) + " 1");
    run("site add " + quoted(at("site")) + " " + quoted(at("two")));
    // The east room with its door and the floor before it, in the frame of the first scan.
    std::ofstream(at("east.geojson"))
        << R"({"type": "Polygon", "coordinates": [[[13,-10],[17,-10],[17,10],[13,10],[13,-10]]]})";
  }
  static test::Outcome run(const std::string& what, int code = 0) {
    test::Outcome outcome = test::run_strata(what + " --quiet 2>&1");
    EXPECT_EQ(outcome.code, code) << what << "\n" << outcome.out;
    return outcome;
  }
  void learn(int day, const std::string& rest) const {
    run("learn " + quoted(at("days/day_" + std::to_string(day) + "/log.clf")) + " " + rest);
  }
  [[nodiscard]] json ask(const std::string& what) const {
    return json::parse(run("site " + what + " --json").out, nullptr, false);
  }
  [[nodiscard]] fs::path at(const std::string& name) const { return folder_.path() / name; }
  [[nodiscard]] std::string in_east() const {
    return " --region " + quoted(at("east.geojson")) + " ";
  }
  /// Of the differences from the first version, those that lie in the region, and all.
  static std::pair<std::size_t, std::size_t> differences(const json& diff) {
    std::size_t east = 0;
    for (const json& feature : diff["features"]) {
      const double x = feature["properties"]["center"][0];
      east += x > 13.0 && x < 17.0 ? 1U : 0U;
    }
    return {east, diff["features"].size()};
  }

  test::TemporaryDirectory folder_;
};

TEST_F(SiteMerge, TakesOneRegionOfAVersionOverTheActiveOne) {
  const std::string site = quoted(at("site"));
  const json merged =
      ask("merge " + site + " 2" + in_east() + "--note east --out " + quoted(at("merged")));
  EXPECT_EQ(merged["state"], "candidate");
  EXPECT_THAT(merged.dump(), HasSubstr("what version 2"));
  const auto [east, all] = differences(ask("diff " + site + " active newest"));
  EXPECT_GT(east, 0U);
  EXPECT_EQ(all, east);
  const auto [whole_east, whole] = differences(ask("diff " + site + " active 2"));
  EXPECT_GT(whole, whole_east) << "or the region makes no difference";
  EXPECT_EQ(maps::read_maps(at("merged")).patches->submaps.size(), 1U);
  EXPECT_EQ(maps::read_maps(at("two")).patches->submaps.size(), 3U);
  (void)ask("merge " + site + " 2" + in_east() + "--anew --out " + quoted(at("anew")));
  EXPECT_EQ(maps::read_maps(at("anew")).patches->submaps.size(), 0U) << "only ever seen open";
  EXPECT_THAT(ask("diff " + site + " active newest").dump(), Not(HasSubstr("forgotten")));
  run("site approve " + site + " newest");
  run("site approve " + site + " 3");
  run("site activate " + site + " 3");
  // Now that its run is known there, version 2 has nothing more to give.
  EXPECT_THAT(run("site merge " + site + " 2" + in_east() + "--out " + quoted(at("more")), 2).out,
              HasSubstr("no run that the active one does not know"));
  EXPECT_FALSE(fs::exists(at("more")));
}

TEST_F(SiteMerge, LearnsARegionOfNewLogsAloneAndAnew) {
  const std::string update =
      "--update " + quoted(at("one")) + " --only-in " + quoted(at("east.geojson"));
  learn(2, update + " --out " + quoted(at("only")));
  learn(2, update + " --anew --out " + quoted(at("anew")));
  const maps::Maps before = maps::read_maps(at("one"));
  const auto west_of = [](const ReflectionGrid& grid) {
    CellRect rect = grid.rect();
    rect.max.x = 250;
    return grid.cropped(rect).values();
  };
  EXPECT_EQ(maps::read_maps(at("only")).patches->submaps.size(), 1U);
  EXPECT_EQ(maps::read_maps(at("anew")).patches->submaps.size(), 0U) << "only ever seen open";
  for (const char* name : {"only", "anew"}) {
    EXPECT_EQ(maps::read_earlier_runs(at(name)).next_run, 2) << name << ": the new run has a place";
    const ReflectionGrid now = maps::read_maps(at(name)).filtered.cropped(before.filtered.rect());
    const auto expected = west_of(before.filtered);
    const auto got = west_of(now);
    ASSERT_EQ(got.size(), expected.size());
    EXPECT_TRUE(std::equal(got.begin(), got.end(), expected.begin(), [](float a, float b) {
      return a == b || (std::isnan(a) && std::isnan(b));
    })) << name;
  }
}

TEST_F(SiteMerge, SaysWhatIsWrongWithARegion) {
  const auto refused = [&](const std::string& text, const std::string& why) {
    std::ofstream(at("region.geojson")) << text;
    const auto outcome = run("site merge " + quoted(at("site")) + " 2 --region " +
                                 quoted(at("region.geojson")) + " --out " + quoted(at("never")),
                             2);
    EXPECT_THAT(outcome.out, HasSubstr(why)) << text;
    EXPECT_THAT(outcome.out, HasSubstr("; ")) << "no remedy";
    EXPECT_FALSE(fs::exists(at("never")));
  };
  refused("{", "is no JSON");
  refused("[]", "geometry");
  refused("{}", "geometry");
  refused(R"({"type": "FeatureCollection", "features": []})", "has no polygon");
  refused(R"({"type": "FeatureCollection", "features": 3})", "geometry");
  refused(R"({"type": "Point", "coordinates": [1, 2]})", "geometry");
  refused(R"({"type": "Polygon", "coordinates": [[[1,1],[1.01,1],[1.01,1.01],[1,1.01],[1,1]]]})",
          "holds the middle of no cell");
  refused(R"({"type": "Polygon", "coordinates": [[[0,0],[1e9,0],[1e9,1],[0,1],[0,0]]]})",
          "further than 10 km");
}

}  // namespace
}  // namespace strata::tools
