// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <filesystem>
#include <set>
#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "tests/support/test_data.hpp"
#include "tools/laboratory/paper/figures.hpp"
#include "tools/laboratory/paper/make_figures.hpp"
#include "tools/laboratory/paper/paper_command.hpp"
#include "tools/laboratory/paper/paper_page.hpp"
#include "tools/laboratory/paper/pose_error.hpp"

namespace strata::paper {
namespace {

using testing::HasSubstr;
using testing::Not;

Figure made_up(const std::string& id, std::function<Outcome(const Setting&)> make) {
  return {id, "toy", "title of " + id, "it <shows> it.", "a > b.", "numbers", std::move(make), ""};
}

Outcome held(std::vector<Number> numbers) { return judged(true, "", std::move(numbers), {}); }

std::vector<Figure> three() {
  return {made_up("toy-1",
                  [](const Setting&) {
                    return held({{"a | b", 1.0, 2.5, 1}});
                  }),
          made_up("toy-2", [](const Setting&) -> Outcome { throw std::runtime_error("no <log>"); }),
          made_up("toy-3", [](const Setting&) {
            return judged(false, "too few", {{"n", {}, 3.0, 0}}, {});
          })};
}

TEST(PaperFigures, AnUnknownNameIsAnErrorThatListsTheNames) {
  try {
    (void)select(three(), {"toy-1", "toy-9"});
    FAIL() << "it was taken";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("toy-9"));
    EXPECT_THAT(error.what(), HasSubstr("all, toy, toy-1, toy-2, toy-3"));
  }
}

TEST(PaperFigures, AreSelectedOnceAndInTheirOrder) {
  const auto figures = select(three(), {"toy-3", "toy-1", "toy-3"});
  ASSERT_EQ(figures.size(), 2U);
  EXPECT_EQ(figures[0].id, "toy-1");
  EXPECT_EQ(select(three(), {"all"}).size(), 3U);
  EXPECT_EQ(select(three(), {"toy"}).size(), 3U);
}

TEST(PaperFigures, OneThatThrowsIsNotMadeAndTheOthersGoOn) {
  std::size_t told = 0;
  const auto rows = make_all(
      three(), {}, [&](const std::vector<Row>& so_far) { EXPECT_EQ(so_far.size(), ++told); });
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(told, 3U);
  EXPECT_EQ(rows[0].outcome.verdict, Verdict::kHeld);
  EXPECT_EQ(rows[1].outcome.verdict, Verdict::kNotMade);
  EXPECT_EQ(rows[1].outcome.reason, "no <log>");
  EXPECT_EQ(rows[2].outcome.verdict, Verdict::kNotHeld);
}

TEST(PaperFigures, NoneHoldsWithoutANumber) {
  const double nan = std::nan("");
  for (const auto& numbers : {std::vector<Number>{}, {{"a", 1.0, {}, 1}}, {{"a", {}, nan, 1}}}) {
    const Row row = make(made_up("toy", [&](const Setting&) { return held(numbers); }), {});
    EXPECT_EQ(row.outcome.verdict, Verdict::kNotMade);
    EXPECT_THAT(row.outcome.reason, HasSubstr("without a number"));
  }
}

TEST(PaperFigures, TheTableHasVerdictNumbersReasonAndSum) {
  const std::string text = text_table(make_all(three(), {}, nullptr));
  EXPECT_THAT(text,
              HasSubstr("| toy-1 | title of toy-1 | held | a \\| b 2.5 (the paper's form 1.0)"));
  EXPECT_THAT(text, HasSubstr("| toy-2 | title of toy-2 | not made |  | no <log> |"));
  EXPECT_THAT(text, HasSubstr("| toy-3 | title of toy-3 | not held | n 3 | too few |"));
  EXPECT_THAT(text, HasSubstr("1 held, 1 not held, 1 not made, of 3"));
}

TEST(PaperFigures, ThePageShowsEveryRowAndEscapesItsText) {
  const test::TemporaryDirectory folder;
  EXPECT_EQ(write_page(folder.path(), make_all(three(), {}, nullptr)), "");
  const std::string page = test::bytes_of(folder.path() / "index.html");
  for (const char* id : {"toy-1", "toy-2", "toy-3"}) EXPECT_THAT(page, HasSubstr(id));
  EXPECT_THAT(page, HasSubstr("it &lt;shows&gt; it."));
  EXPECT_THAT(page, Not(HasSubstr("<log>")));
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "results.json"));
}

TEST(PaperFigures, TheSumCountsEachVerdict) {
  auto rows = make_all(three(), {}, nullptr);
  rows.insert(rows.end(), 2, rows[0]);
  rows.push_back(rows[2]);
  EXPECT_EQ(sum_of(rows), "3 held, 2 not held, 1 not made, of 6");
}

TEST(PaperFigures, JsonHasNullForWhatIsMissing) {
  const auto json = to_json(make_all(three(), {}, nullptr));
  EXPECT_EQ(json[0]["numbers"][0]["ours"], 2.5);
  EXPECT_TRUE(json[2]["numbers"][0]["papers_form"].is_null());
  EXPECT_EQ(json[1]["verdict"], "not made");
}

TEST(PaperFigures, OfABoxAreMadeOfItsScenarioWithPictures) {
  Setting setting;
  setting.scenarios = STRATA_SCENARIO_DIR;
  const Row row = make(select(all_figures(), {"patch-1.12"}).front(), setting);
  EXPECT_EQ(row.outcome.verdict, Verdict::kHeld) << row.outcome.reason;
  ASSERT_EQ(row.outcome.numbers.size(), 3U);
  EXPECT_EQ(row.outcome.numbers[1].ours, 3.0) << "places of the box";
  ASSERT_EQ(row.outcome.pictures.size(), 1U);
  EXPECT_THAT(std::get<std::string>(row.outcome.pictures[0].content), HasSubstr("PNG"));
}

TEST(PaperFigures, OfRoomsAreTexturedWithoutPeople) {
  Setting setting;
  setting.scenarios = STRATA_SCENARIO_DIR;
  setting.first_seed = 112;  // no figure uses it
  setting.seeds = 1;
  const Row row = make(select(all_figures(), {"em-1.10"}).front(), setting);
  EXPECT_EQ(row.outcome.verdict, Verdict::kHeld) << row.outcome.reason;
  ASSERT_EQ(row.outcome.numbers.size(), 9U);
  EXPECT_GT(*row.outcome.numbers[2].ours, 0.8) << "share of the voxels in polygons";
  EXPECT_GT(*row.outcome.numbers[6].ours, 100.0) << "texels of people without filtering";
  EXPECT_EQ(row.outcome.pictures.size(), 2U);
}

TEST(PaperFigures, TheMassOfTheTruthIsOfLandmarksThatWereFound) {
  Setting setting;
  setting.seeds = 1;
  const Row row = make(select(all_figures(), {"ptm-mass-1"}).front(), setting);
  ASSERT_EQ(row.outcome.numbers.size(), 5U) << row.outcome.reason;
  EXPECT_EQ(row.outcome.numbers[0].ours, 1.0) << "seeds";
  EXPECT_GE(row.outcome.numbers[1].ours, 11.0) << "visits";
  const double mass = row.outcome.numbers[2].ours.value_or(-1.0);
  EXPECT_GE(mass, 0.0);
  EXPECT_LE(mass, 1.0);
  EXPECT_EQ(row.outcome.verdict, mass >= 0.94 ? Verdict::kHeld : Verdict::kNotHeld);
}

TEST(PaperPoseError, IsThatAfterTheBestRigidMotion) {
  const std::vector<Pose2> way{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}};
  const Pose2 map_from_truth{10.0, -3.0, 1.0};
  std::vector<PosedScan> scans;
  std::vector<log::StampedPose> truth;
  for (std::size_t i = 0; i < way.size(); ++i) {
    const Stamp stamp{static_cast<std::int64_t>(i) * 1'000'000'000};
    truth.push_back({stamp, way[i]});
    scans.emplace_back().scan.stamp = stamp;
    scans.back().map_from_robot = map_from_truth * way[i];
  }
  EXPECT_NEAR(pose_error_m(scans, truth), 0.0, 1e-9);
  // A square stretched on one side by 2 m: each corner stays 1 m off its place.
  for (const std::size_t i : {1U, 2U})
    scans[i].map_from_robot = map_from_truth * Pose2{6, way[i].y, 0};
  EXPECT_NEAR(pose_error_m(scans, truth), 1.0, 1e-9);
}

TEST(PaperPoseError, KnowsTheTruthOnlyWhereThereIsOne) {
  pipeline::Runs runs;
  runs.observations.resize(3);
  for (std::size_t i = 0; i < 3; ++i) {
    runs.observations[i].scan.stamp = Stamp{static_cast<std::int64_t>(i)};
  }
  runs.truths = {Pose2{1, 2, 0}, std::nullopt, Pose2{3, 4, 0}};
  const auto truth = stamped_truth(runs);
  ASSERT_EQ(truth.size(), 2U);
  EXPECT_EQ(truth[1].stamp, Stamp{2});
  EXPECT_EQ(truth[1].pose.x, 3.0);
}

/// Exit status, and what went to stdout and stderr.
std::tuple<int, std::string, std::string> command(std::vector<std::string> words) {
  words.insert(words.begin(), "paper");
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const int status =
      paper_command(static_cast<int>(pointers.size()), pointers.data(), "no/scenarios");
  const std::string out = testing::internal::GetCapturedStdout();
  return {status, out, testing::internal::GetCapturedStderr()};
}

TEST(PaperCommand, WithoutScenariosOrLogsSaysOfEachRowWhatIsMissing) {
  const test::TemporaryDirectory folder;
  const auto [status, out, errors] = command(
      {"patch-1.11", "em-1.9", "em-1.10", "--data", "no/data", "--out", folder.path(), "--json"});
  EXPECT_EQ(status, 0);
  const auto rows = nlohmann::json::parse(out);
  ASSERT_EQ(rows.size(), 3U);
  for (const auto& row : rows) EXPECT_EQ(row["verdict"], "not made");
  EXPECT_THAT(rows[0]["reason"], HasSubstr("no/data/radish/freiburg-campus"));
  EXPECT_THAT(rows[0]["reason"], HasSubstr("--data"));
  EXPECT_THAT(rows[2]["reason"], HasSubstr("no/scenarios/three_doors.yaml"));
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "index.html"));
}

TEST(PaperCommand, ListsNamesAndRefusesOthers) {
  EXPECT_THAT(std::get<1>(command({"list"})), HasSubstr("kessler-table-1: "));
  const auto [status, out, errors] = command({"em-9"});
  EXPECT_EQ(status, 1);
  EXPECT_THAT(errors, HasSubstr("kessler-table-1"));
}

TEST(PaperFigures, AreEachMadeOrSayWhyNot) {
  std::set<std::string> ids;
  for (const Figure& figure : all_figures()) {
    EXPECT_TRUE(ids.insert(figure.id).second) << figure.id;
    EXPECT_NE(figure.make != nullptr, !figure.missing.empty()) << figure.id;
    EXPECT_FALSE(figure.shows.empty()) << figure.id;
    EXPECT_FALSE(figure.criterion.empty()) << figure.id;
  }
  EXPECT_EQ(ids.size(), 30U);
}

}  // namespace
}  // namespace strata::paper
