// SPDX-License-Identifier: Apache-2.0
/// `strata site`, as a user calls it, and as `kill -9` ends it.
#include "components/site/site.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <future>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/components/site/small_maps.hpp"
#include "tests/support/comes_true.hpp"
#include "tests/tools/strata/site_fixture.hpp"

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

using nlohmann::json;
using test::Outcome;
using test::quoted;
using testing::HasSubstr;

TEST_F(SiteVerb, MakesLevelsWithMapsOfTheirOwn) {
  EXPECT_THAT(site("init", "--id house").out, HasSubstr("made site house"));
  EXPECT_EQ(site("levels", "add 1 --elevation 3.5").code, 0);
  EXPECT_EQ(ask("levels", "add 0 --elevation 0 --id ground")["mapId"], "ground");
  EXPECT_EQ(site("levels", "add 1 --elevation 7").code, 2);
  test::write_small_maps(at("maps"), "a");
  const std::string level = quoted(at("site/levels/1"));
  const auto of_level = [&](const std::string& rest) {
    return test::run_strata("site " + rest + " 2>&1").code;
  };
  EXPECT_EQ(of_level("add " + level + " " + quoted(at("maps"))), 0);
  EXPECT_EQ(of_level("approve " + level + " 1 --unchecked"), 0);
  EXPECT_EQ(of_level("activate " + level + " 1"), 0);
  const json all = ask("levels", "list");
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0]["name"], "0");
  EXPECT_EQ(all[0]["active"], nullptr);
  EXPECT_EQ(all[1]["elevation_m"], 3.5);
  EXPECT_EQ(all[1]["mapId"], "house-1");
  EXPECT_EQ(all[1]["active"]["mapVersion"], "1");
  EXPECT_EQ(ask("status")["levels"], (json{"0", "1"}));
  EXPECT_EQ(site("add", quoted(at("maps"))).code, 2);  // a building has none of its own
  std::ofstream(at("lift.geojson"))
      << R"({"type": "Feature", "properties": {"name": "a", "kind": "lift", "levels": ["1", "9"]},)"
      << R"("geometry": {"type": "Polygon", "coordinates": [[[0,0],[2,0],[2,2],[0,0]]]}})";
  EXPECT_THAT(site("zones", "add " + quoted(at("lift.geojson"))).out, HasSubstr("1 zone"));
  EXPECT_THAT(site("levels", "list").out, HasSubstr("serves level '9', which the site has not"));
  EXPECT_EQ(site("levels", "remove 1").code, 2);
  EXPECT_EQ(ask("levels", "remove 0"), json{"1"});
}

TEST_F(SiteVerb, LeadsMapsFromTheFolderToTheRobotAndBack) {
  EXPECT_THAT(site("init", "--id hall-3").out, HasSubstr("made site hall-3"));
  const std::string a = approved("a");
  const std::string b = approved("b");
  EXPECT_EQ(ask("activate", "1")["mapHash"], a);
  const json now = ask("activate", b.substr(0, 12) + " --by ada");
  EXPECT_EQ(now["mapHash"], b);
  EXPECT_EQ(now["from"], a);
  EXPECT_EQ(now["mapVersion"], "2");
  EXPECT_EQ(now["mapId"], "hall-3");
  const json status = ask("status");
  EXPECT_EQ(status["active"]["mapHash"], b);
  EXPECT_EQ(status["previous"]["mapHash"], a);
  EXPECT_EQ(status["active_fault"], "");
  EXPECT_EQ(status["diary"].back()["by"], "ada");
  EXPECT_EQ(ask("rollback")["mapHash"], a);
  EXPECT_EQ(ask("list").size(), 2U);
  EXPECT_EQ(ask("list")[1]["state"], "retired");
  EXPECT_THAT(site("list").out, HasSubstr("retired"));
  EXPECT_THAT(site("status", "--diary 3").out, HasSubstr("rollback"));
  EXPECT_EQ(ask("gc", "--dry-run").size(), 0U);
  // What robots and other verbs are given.
  const json info = json::parse(test::run_strata("info --json " + quoted(at("site/active"))).out);
  EXPECT_EQ(info["mapHash"], a);
  EXPECT_EQ(info["mapId"], "hall-3");
  EXPECT_EQ(info["mapVersion"], "1");
  EXPECT_THAT(test::run_strata("info " + quoted(at("site"))).out, HasSubstr("site hall-3"));
}

TEST_F(SiteVerb, SaysWhatIsWrongAndWhatToDo) {
  const auto expect = [](const Outcome& outcome, int code, const std::string& text) {
    EXPECT_EQ(outcome.code, code) << outcome.out;
    EXPECT_THAT(outcome.out, HasSubstr(text));
    EXPECT_THAT(outcome.out, HasSubstr("; ")) << "no remedy";
  };
  expect(site("status"), 2, "is no site");
  EXPECT_EQ(site("init", "--id hall-3").code, 0);
  expect(site("init", "--id hall-3"), 1, "exists already");
  expect(site("add", quoted(at("nothing"))), 2, "is no folder");
  expect(site("activate", "1"), 2, "has no version '1'");
  expect(site("rollback"), 2, "nothing to go back to");
  test::write_small_maps(at("a"), "a");
  EXPECT_EQ(site("add", quoted(at("a"))).code, 0);
  expect(site("activate", "1"), 2, "was not approved");
  const std::string hash = ask("list")[0]["mapHash"];
  std::ofstream(at("site/versions") / hash / "maps/summary.json", std::ios::app) << " ";
  expect(site("approve", "1 --unchecked"), 2, "summary.json was changed");
  EXPECT_THAT(test::run_strata("info " + quoted(at("site"))).out, HasSubstr("active    none"));
}

/// A night at a time: what was learned is taken where the kept recordings say that it is as good.
TEST_F(SiteVerb, TakesWhatANightLearnedWhereTheKeptRecordingsAllowIt) {
  const std::string days = quoted(at("days"));
  ASSERT_EQ(test::run_strata(
                "simulate '" STRATA_SOURCE_DIR
                "/tools/simulate/scenarios/empty_room.yaml' --set days=3 --per-day --quiet --out " +
                days)
                .code,
            0);
  const auto day = [&](int number) {
    return quoted(at("days/day_" + std::to_string(number) + "/log.clf"));
  };
  const auto learn = [&](const std::string& rest) {
    return test::run_strata("learn " + rest + " --quiet --only em").code;
  };
  ASSERT_EQ(learn(day(1) + " --out " + quoted(at("maps"))), 0);
  ASSERT_EQ(site("init", "--id hall-3").code, 0);
  EXPECT_EQ(ask("take", quoted(at("maps")))["state"], "active") << "the first needs no recording";
  ASSERT_EQ(learn(day(2) + " --update " + quoted(at("maps")) + " --out " + quoted(at("next"))), 0);
  const Outcome unknown = site("take", quoted(at("next")));
  EXPECT_EQ(unknown.code, 2);
  EXPECT_THAT(unknown.out, HasSubstr("keeps no recording"));
  EXPECT_EQ(ask("keep", day(3)).size(), 1U);
  const json taken = ask("take", quoted(at("next")) + " --by cron");
  EXPECT_EQ(taken["state"], "active");
  EXPECT_EQ(taken["mapVersion"], "2");
  EXPECT_THAT(site("take", quoted(at("next"))).out, HasSubstr("already, active"));
  // Another night somebody learns in a frame of his own.
  ASSERT_EQ(learn(day(2) + " --out " + quoted(at("other"))), 0);
  const Outcome other = site("take", quoted(at("other")));
  EXPECT_EQ(other.code, 2) << other.out;
  EXPECT_THAT(other.out, HasSubstr("was refused"));
  EXPECT_EQ(ask("status")["active"]["mapVersion"], "2");
  EXPECT_EQ(ask("list")[2]["state"], "candidate") << "to be looked at";
}

TEST_F(SiteVerb, KeepsZonesThatGoToNav2AndBack) {
  ASSERT_EQ(site("init", "--id hall-3").code, 0);
  std::ofstream(at("z.geojson")) << R"({"type": "FeatureCollection", "drawn by": "Ada", "features":
    [{"type": "Feature", "properties": {"name": "dock", "kind": "keepout", "color": "red"},
      "geometry": {"type": "Polygon", "coordinates": [[[0,0],[2,0],[2,1],[0,1],[0,0]]]}}]})";
  EXPECT_EQ(ask("zones", "set " + quoted(at("z.geojson"))).size(), 1U);
  EXPECT_THAT(site("zones", "list").out, HasSubstr("dock: keepout, 2.00 m2"));
  EXPECT_EQ(site("zones", "mask keepout --quiet --out " + quoted(at("mask"))).code, 0);
  EXPECT_THAT(test::bytes_of(at("mask/nav2_params.yaml")), HasSubstr("type: 0"));
  EXPECT_EQ(ask("zones", "import speed_m_s --multiplier 0.02 --name ramp " +
                             quoted(at("mask/keepout.yaml")))[1]["speed_m_s"],
            2.0);
  EXPECT_EQ(ask("zones", "remove dock --by grace").size(), 1U);
  EXPECT_EQ(ask("status")["diary"].back()["by"], "grace");
  EXPECT_EQ(ask("zones", "import keepout " + quoted(at("mask/keepout.yaml")))[1]["area_m2"], 2.0);
  EXPECT_EQ(site("zones", "export " + quoted(at("out.geojson"))).code, 0);
  EXPECT_THAT(test::bytes_of(at("out.geojson")), HasSubstr(R"("drawn by": "Ada")"));
  EXPECT_EQ(site("zones", "draw " + quoted(at("zones.png"))).code, 0);
  EXPECT_GT(fs::file_size(at("zones.png")), 100U);
  const Outcome twice = site("zones", "add " + quoted(at("out.geojson")));
  EXPECT_EQ(twice.code, 2);
  EXPECT_THAT(twice.out, HasSubstr("feature 1: properties.name: is \"ramp\""));
  std::ofstream(at("tape.geojson")) << R"({"type": "FeatureCollection", "features":
    [{"type": "Feature", "properties": {"name": "tape", "kind": "keepout"},
      "geometry": {"type": "Polygon", "coordinates": [[[0,3.01],[2,3.01],[2,3.02],[0,3.02],[0,3.01]]]}}]})";
  const Outcome tape = site("zones", "add " + quoted(at("tape.geojson")));
  EXPECT_EQ(tape.code, 0);
  EXPECT_THAT(tape.out, HasSubstr("these zones do nothing: 'tape'"));
  EXPECT_EQ(site("zones", "mask sped --out " + quoted(at("no"))).code, 2);
  EXPECT_FALSE(fs::exists(at("no")));
}

TEST_F(SiteVerb, TakesOnlyZonesThatRobotsAreToldOf) {
  const auto zones = [&](const std::string& name, const std::string& rest, double x_m) {
    const std::string x = std::to_string(x_m);
    return R"({"type": "Feature", "properties": {"name": ")" + name + R"(", "kind": )" + rest +
           R"(}, "geometry": {"type": "Polygon", "coordinates": [[[)" + x + ",0],[" + x + ",2],[" +
           std::to_string(x_m + 2.0) + ",2],[" + x + ",0]]]}}";
  };
  const auto write = [&](const std::string& features) {
    std::ofstream(at("z.geojson"))
        << R"({"type": "FeatureCollection", "features": [)" << features << "]}";
    return quoted(at("z.geojson"));
  };
  const auto refused = [](const Outcome& outcome, const std::string& why) {
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.out, HasSubstr(why));
  };
  const std::string stairs = zones("stairs", R"("keepout")", 0.0);
  const std::string lift = zones("lift", R"("lift")", 0.0);
  ASSERT_EQ(site("init", "--id hall-3").code, 0);
  ASSERT_EQ(site("zones", "set " + write(stairs)).code, 0);
  const std::string slow = zones("slow", R"("speed", "speed_m_s": 0.02)", 4.0);
  const std::string fast = zones("fast", R"("speed", "speed_m_s": 5)", 8.0);
  refused(site("zones", "add " + write(slow + "," + fast)), "zone 'slow': is too slow");
  refused(site("zones", "set " + write(slow + "," + fast)), "zone 'slow': is too slow");
  std::string far = zones("far", R"("keepout")", 9e3);
  far.replace(far.find(",2]"), 3, ",9000]");
  refused(site("zones", "add " + write(far)), "40 million cells");
  EXPECT_EQ(ask("zones", "list").size(), 1U) << "what is refused changes nothing";
  EXPECT_EQ(site("zones", "add " + write(slow)).code, 0);

  ASSERT_EQ(test::run_strata("site init " + quoted(at("house")) + " --id house").code, 0);
  ASSERT_EQ(test::run_strata("site levels " + quoted(at("house")) + " add 0 --elevation 0").code,
            0);
  const auto add_to = [&](const std::string& folder, const std::string& features) {
    return test::run_strata("site zones " + quoted(at(folder)) + " add " + write(features) +
                            " 2>&1");
  };
  refused(add_to("house", stairs), "is of kind keepout, which a building has none of");
  refused(add_to("house/levels/0", lift), "is of kind lift, which a level has none of");
  EXPECT_EQ(add_to("house", lift).code, 0);
  EXPECT_EQ(add_to("house/levels/0", stairs).code, 0);
}

TEST_F(SiteVerb, OutlivesKillsAtAnyMoment) {
  ASSERT_EQ(site("init", "--id hall-3").code, 0);
  const std::string a = approved("a");
  const std::string b = approved("b");
  ASSERT_EQ(site("activate", "1").code, 0);
  test::write_small_maps(at("c"), "c");
  const std::string words[] = {"add", "activate", "rollback", "approve"};
  for (int i = 0; i < 40; ++i) {
    const std::string& action = words[i % 4];
    const std::string rest = action == "add"        ? quoted(at("c"))
                             : action == "approve"  ? "2 --unchecked"
                             : action == "activate" ? "2"
                                                    : "";
    (void)test::run_strata_under("timeout --signal=KILL " + std::to_string(0.001 * (i + 1)),
                                 "site " + action + " --quiet " + quoted(at("site")) + " " + rest);
    const site::Site there(at("site"));
    ASSERT_TRUE(there.active()) << i;
    EXPECT_TRUE(*there.active() == a || *there.active() == b) << i;
    for (const auto& status : there.versions()) {
      EXPECT_EQ(there.fault_of(status.version.hash), "") << i;
    }
  }
  EXPECT_EQ(site("add", quoted(at("c"))).code, 0);
  EXPECT_EQ(ask("status")["active_fault"], "");
}

}  // namespace
}  // namespace strata::tools
