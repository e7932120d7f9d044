// SPDX-License-Identifier: Apache-2.0
/// `strata site plan`, as a user calls it.
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "components/log/map_file.hpp"
#include "components/maps/maps_folder.hpp"
#include "components/site/site.hpp"
#include "tests/core/plan/painted.hpp"
#include "tests/tools/strata/site_fixture.hpp"

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

using nlohmann::json;
using test::Outcome;
using test::quoted;
using testing::HasSubstr;

/// An architect's plan: found on the map, kept, and a map to localize in where there is no other.
TEST_F(SiteVerb, PutsAFloorPlanOnTheMapAndKeepsItThere) {
  ASSERT_EQ(site("init", "--id hall-3").code, 0);
  test::write_small_maps(at("maps"), "a");
  {
    memory::Store store(at("maps") / maps::kStoreFile);
    store.save_grid("filtered", test::seen(test::building()));
  }
  ASSERT_EQ(ask("add", quoted(at("maps")))["mapVersion"], "1");
  const auto draw = [&](const std::string& name, const std::vector<test::Line>& lines,
                        const Pose2& site_from_plan) {
    log::write_map(at(name + ".yaml"), test::drawn(lines, {site_from_plan, 1.0}),
                   {.image = log::MapImageFormat::kPng});
    return quoted(at(name + ".png"));
  };
  // The picture's corner is 10 m to the left of and below the plan's origin.
  const std::string office = draw("office", test::building(), {1.0, -0.5, 0.6});
  const Outcome early = site("plan", "set " + office + " --metres-per-pixel 0.02");
  EXPECT_EQ(early.code, 2);
  EXPECT_THAT(early.out, HasSubstr("no active version"));
  ASSERT_EQ(site("approve", "1 --unchecked").code, 0);
  ASSERT_EQ(site("activate", "1").code, 0);
  EXPECT_THAT(site("plan", "set " + office).out, HasSubstr("needs its scale"));
  EXPECT_THAT(site("plan", "set " + office + " --metres-per-pixel 0.03").out,
              HasSubstr("check that it is this floor, and its scale"));
  EXPECT_THAT(site("plan", "set " + office + " --metres-per-pixel 0.02 --near 1,2,nan").out,
              HasSubstr("is not 3 numbers"));
  EXPECT_EQ(site("plan", "show").code, 2) << "what was refused is not kept";
  const json set = ask("plan", "set " + office + " --between 0,0,300,400 --metres 10 --by ada");
  const Pose2 corner{1.0 - 10.0 * std::cos(0.6) + 10.0 * std::sin(0.6),
                     -0.5 - 10.0 * std::sin(0.6) - 10.0 * std::cos(0.6), 0.6};
  EXPECT_NEAR(set["site_from_plan"]["x_m"], corner.x, 0.05);
  EXPECT_NEAR(set["site_from_plan"]["y_m"], corner.y, 0.05);
  EXPECT_NEAR(set["site_from_plan"]["theta_rad"], 0.6, 0.003);
  EXPECT_EQ(set["version"], ask("list")[0]["mapHash"]);
  EXPECT_EQ(ask("plan", "show"), set);
  EXPECT_EQ(ask("status")["plan"], "office.png");
  EXPECT_THAT(site("status").out, HasSubstr("plan      office.png"));
  EXPECT_THAT(site("plan", "set " + office + " --metres-per-pixel 0.02").out,
              HasSubstr("has a plan already"));
  EXPECT_EQ(site("plan", "draw " + quoted(at("over.png"))).code, 0);
  EXPECT_GT(fs::file_size(at("over.png")), 1000U);
  EXPECT_EQ(site("plan", "map --quiet --out " + quoted(at("plan_maps"))).code, 0);
  const ReflectionGrid map = log::read_map(at("plan_maps/plan.yaml"));
  EXPECT_TRUE(is_by_a_wall(map, map.cell_at({5.0, -1.0})));
  EXPECT_TRUE(is_free(map.get(map.cell_at({3.0, -1.0}))));
  EXPECT_EQ(ask("plan", "remove --by grace"), json(nullptr));
  EXPECT_EQ(ask("status")["plan"], json(nullptr));
  // The same after half a turn: somebody has to say which.
  test::write_small_maps(at("hall_maps"), "b");
  {
    memory::Store store(at("hall_maps") / maps::kStoreFile);
    store.save_grid("filtered", test::seen(test::hall(), false));
  }
  ASSERT_EQ(ask("add", quoted(at("hall_maps")))["mapVersion"], "2");
  ASSERT_EQ(site("approve", "2 --unchecked").code, 0);
  ASSERT_EQ(site("activate", "2").code, 0);
  const std::string hall = draw("hall", test::hall(), {0.0, 0.0, 0.0});
  const Outcome two = site("plan", "set " + hall + " --metres-per-pixel 0.02");
  EXPECT_EQ(two.code, 2);
  EXPECT_THAT(two.out, HasSubstr("fits in two places alike"));
  EXPECT_THAT(two.out, HasSubstr("say which with --near"));
  EXPECT_NEAR(ask("plan", "set " + hall +
                              " --metres-per-pixel 0.02 --near 9,9,175")["site_from_plan"]["x_m"],
              10.0, 0.05);
}

/// Before there is any map the plan's frame is the site's, and a robot is found on the plan.
TEST_F(SiteVerb, LocalizesOnAFloorPlanAlone) {
  ASSERT_EQ(site("init", "--id hall-3").code, 0);
  std::vector<test::Line> room;  // that of scenarios/empty_room.yaml
  test::add_box(room, 0.0, 0.0, 6.0, 4.0);
  log::write_map(at("room.yaml"), test::painted(room, 0.03, 0.02, 11.0, 0.0F));
  const json set = ask("plan", "set " + quoted(at("room.yaml")));
  EXPECT_EQ(set["fit"], json(nullptr));
  EXPECT_EQ(set["site_from_plan"]["x_m"], 0.0);
  EXPECT_EQ(site("plan", "map --quiet --out " + quoted(at("maps"))).code, 0);
  ASSERT_EQ(test::run_strata("simulate '" STRATA_SOURCE_DIR
                             "/tools/simulate/scenarios/empty_room.yaml' --set days=1 --quiet "
                             "--out " +
                             quoted(at("sim")))
                .code,
            0);
  const Outcome localized = test::run_strata(
      "localize " + quoted(at("sim/log.clf")) + " --truth " + quoted(at("sim/truth.tum")) +
      " --maps " + quoted(at("maps")) +
      " --model filtered --set sensor_model=likelihood_field --json --out " + quoted(at("run")));
  ASSERT_EQ(localized.code, 0) << localized.out;
  const json metrics = json::parse(localized.out, nullptr, false);
  EXPECT_EQ(metrics["lost"], false);
  EXPECT_LT(metrics["error_m"]["mean"], 0.1);
}

}  // namespace
}  // namespace strata::tools
