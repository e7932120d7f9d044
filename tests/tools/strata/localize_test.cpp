// SPDX-License-Identifier: Apache-2.0
/// `strata localize` as users meet it: a sentence, a picture, and a word where maps and log do not
/// belong together.
#include <algorithm>
#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "components/log/trajectory_file.hpp"
#include "tests/support/decoded_png.hpp"
#include "tests/support/test_data.hpp"
#include "tests/tools/strata/replay_fixture.hpp"

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

using test::quoted;
using test::run_strata;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kWarning = "warning: these maps do not explain this log";

class Localize : public test::ReplayFixture {
 protected:
  [[nodiscard]] test::Outcome localize(const std::string& more) const {
    return run_strata("localize " + quoted(log()) + " --maps " + quoted(at("direct")) +
                      " --model filtered --out " + quoted(at("out")) + " " + more + " 2>&1");
  }
};

TEST_F(Localize, EndsWithASentenceAndAPictureOfTheWay) {
  const auto told = localize("--initial-pose 0,0,0");
  ASSERT_EQ(told.code, 0) << told.out;
  EXPECT_THAT(told.out,
              ContainsRegex(
                  "localized [0-9]+ scans over [0-9]+[.][0-9] m in [0-9.]+ s; "
                  "the maps explain (9[0-9]|100)% of the drive, at a score of [01][.][0-9]+ in the "
                  "mean; drawn in "));
  EXPECT_THAT(told.out, Not(HasSubstr(kWarning)));
  EXPECT_THAT(told.out, Not(HasSubstr("{")));
  const report::Image drawn = test::decode(test::bytes_of(at("out") / "trajectory.png"));
  const auto is_green = [](const report::Color& c) { return c.g > c.r + 40 && c.g > c.b + 40; };
  EXPECT_GT(std::count_if(drawn.pixels().begin(), drawn.pixels().end(), is_green), 20);
}

TEST_F(Localize, LeavesAReplayThatItReplacesOnTheNextTime) {
  ASSERT_EQ(localize("--initial-pose 0,0,0 --quiet").code, 0);
  const std::string page = test::bytes_of(at("out") / "replay.html");
  EXPECT_THAT(page, HasSubstr("\"name\":\"filtered\""));
  const auto again = localize("--initial-pose 0,0,0 --seed 2 --quiet --force");
  ASSERT_EQ(again.code, 0) << again.out;
  EXPECT_NE(test::bytes_of(at("out") / "replay.html"), page);
}

TEST_F(Localize, PrintsItsMetricsWhenAsked) {
  const auto told = localize("--initial-pose 0,0,0 --json --quiet");
  ASSERT_EQ(told.code, 0) << told.out;
  const auto metrics = nlohmann::json::parse(told.out);
  EXPECT_EQ(metrics, nlohmann::json::parse(test::bytes_of(at("out") / "metrics.json")));
  EXPECT_EQ(metrics["map_fit"]["is_explained"], true);
}

/// Otherwise the robot is looked for, and found.
constexpr const char* kUnwatched = " --set localizer.global_search.watch.is_used=false ";

TEST_F(Localize, FindsARobotThatDidNotBeginAtTheInitialPose) {
  const auto untold = localize("--initial-pose 0,0,0 --quiet");
  ASSERT_EQ(untold.code, 0) << untold.out;
  EXPECT_THAT(untold.out, Not(HasSubstr("did not begin")));
  const auto truth = log::read_trajectory(at("out") / "trajectory.tum");
  const auto told = localize("--initial-pose 1.5,1.5,2.4 --force --quiet");
  ASSERT_EQ(told.code, 0) << told.out;
  EXPECT_THAT(told.out,
              ContainsRegex("warning: the robot did not begin at --initial-pose: no scan spoke "
                            "for it, and after [0-9.]+ s it was found [0-9.]+ m from"));
  const auto found = log::read_trajectory(at("out") / "trajectory.tum");
  ASSERT_EQ(found.size(), truth.size());
  EXPECT_GT(translation_distance(found.front().pose, truth.front().pose), 1.0);
  // The room looks nearly the same turned by half a turn about its middle.
  std::size_t at_one_of_both = 0;
  const Pose2 middle{2.0, 1.0, 0.0};
  for (std::size_t i = truth.size() / 2; i < truth.size(); ++i) {
    const Pose2& right = truth[i].pose;
    const Pose2 turned{2.0 * middle.x - right.x, 2.0 * middle.y - right.y, right.theta};
    at_one_of_both += std::min(translation_distance(found[i].pose, right),
                               translation_distance(found[i].pose, turned)) < 0.5
                          ? 1
                          : 0;
  }
  EXPECT_EQ(at_one_of_both, truth.size() - truth.size() / 2);
}

TEST_F(Localize, SaysThatAWrongInitialPoseIsOne) {
  const auto told = localize("--initial-pose 1.5,1.5,2.4" + std::string(kUnwatched));
  ASSERT_EQ(told.code, 0) << told.out;
  EXPECT_THAT(told.out, HasSubstr(kWarning));
  EXPECT_THAT(told.out, HasSubstr("did the robot begin at --initial-pose? --global looks"));
  const auto metrics = nlohmann::json::parse(test::bytes_of(at("out") / "metrics.json"));
  EXPECT_EQ(metrics["map_fit"]["is_explained"], false);
}

TEST_F(Localize, WarnsAlsoWhenQuietAndKeepsItsJsonClean) {
  const std::string tail = "localize " + quoted(log()) + " --maps " + quoted(at("direct")) +
                           " --model filtered --out " + quoted(at("out")) +
                           " --initial-pose 1.5,1.5,2.4 --quiet --json" + kUnwatched;
  const auto told = run_strata(tail + " 2>" + quoted(at("err")));
  ASSERT_EQ(told.code, 0) << told.out;
  EXPECT_EQ(nlohmann::json::parse(told.out)["map_fit"]["is_explained"], false);
  EXPECT_THAT(test::bytes_of(at("err")), ContainsRegex(std::string("^") + kWarning));
}

TEST_F(Localize, SaysThatATruthLiesInAnotherFrame) {
  ASSERT_EQ(localize("--initial-pose 0,0,0 --quiet").code, 0);
  auto truth = log::read_trajectory(at("out") / "trajectory.tum");
  const auto compared = [&](double moved_m) {
    for (log::StampedPose& pose : truth) pose.pose.x += moved_m;
    log::write_trajectory(at("truth.tum"), truth);
    return localize("--initial-pose 0,0,0 --force --truth " + quoted(at("truth.tum"))).out;
  };
  EXPECT_THAT(compared(0.0), Not(HasSubstr("in another frame")));
  EXPECT_THAT(compared(4.0),
              ContainsRegex("warning: the maps explain [0-9]+% of the drive, and the truth lies "
                            "4[.]0 m off: it is probably in another frame"));
}

TEST_F(Localize, InAReplayWarnsTheSame) {
  const auto replayed = [&](const std::string& more) {
    return replay(log(), test::kCompositions / "localize.yaml", "replayed",
                  "--force --set localizer.maps=" + quoted(at("direct")) +
                      " --set localizer.model=filtered " + more);
  };
  const auto own = replayed("--set 'localizer.start.pose=[0, 0, 0]'");
  ASSERT_EQ(own.code, 0) << own.out;
  EXPECT_THAT(own.out, Not(HasSubstr("do not explain")));
  const auto found = replayed("--set 'localizer.start.pose=[1.5, 1.5, 2.4]'");
  ASSERT_EQ(found.code, 0) << found.out;
  EXPECT_THAT(found.out, HasSubstr("the robot did not begin at start.pose"));
  const auto wrong = replayed(
      "--set 'localizer.start.pose=[1.5, 1.5, 2.4]' "
      "--set localizer.localizer.global_search.watch.is_used=false");
  ASSERT_EQ(wrong.code, 0) << wrong.out;
  EXPECT_THAT(wrong.out, ContainsRegex(std::string(kWarning) + ": of its [0-9]+ weighed scans "));
  EXPECT_THAT(wrong.out, HasSubstr("did the robot begin at start.pose?"));
}

TEST(LocalizeElsewhere, SaysThatMapsOfAnotherBuildingDoNotExplainALog) {
  STRATA_REQUIRE_DATA(castle, "radish/belgioioso/log.clf.gz");
  STRATA_REQUIRE_DATA(castle_truth, "radish/belgioioso/truth.tum");
  STRATA_REQUIRE_DATA(other, "radish/seattle/log.clf.gz");
  const test::TemporaryDirectory folder;
  const auto at = [&](const char* name) { return quoted(folder.path() / name); };
  ASSERT_EQ(
      run_strata("learn " + quoted(castle) + " --poses " + quoted(castle_truth) + " --truth " +
                 quoted(castle_truth) + " --only em --quiet --out " + at("maps"))
          .code,
      0);
  const std::string tail = " --maps " + at("maps") + " --model filtered --out " + at("out");
  for (const char* start : {" --global", " --initial-pose 0,0,0"}) {
    const auto told = run_strata("localize " + quoted(other) + start + tail + " 2>&1");
    EXPECT_EQ(told.code, 0);
    EXPECT_THAT(told.out, HasSubstr(kWarning)) << start;
  }
  const auto own = run_strata("localize " + quoted(castle) + " --truth " + quoted(castle_truth) +
                              tail + " 2>&1");
  EXPECT_EQ(own.code, 0);
  EXPECT_THAT(own.out, Not(HasSubstr(kWarning)));
  EXPECT_THAT(own.out, ContainsRegex("error [0-9.]+ m in the mean"));
}

}  // namespace
}  // namespace strata::tools
