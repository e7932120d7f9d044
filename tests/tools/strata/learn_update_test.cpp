// SPDX-License-Identifier: Apache-2.0
// `strata learn --update` loses nothing that was learned, and counts nothing twice.
#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "memory/store/store_summary.hpp"
#include "tests/support/test_data.hpp"
#include "tests/tools/strata/program.hpp"

namespace strata::tools {
namespace {

using test::Outcome;
using ::testing::HasSubstr;

std::string in_quotes(const std::filesystem::path& path) { return "'" + path.string() + "'"; }

/// Two days in a small hall; the first is learned.
class LearnUpdate : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    days = new test::TemporaryDirectory;
    const Outcome made = test::run_strata("simulate " STRATA_SOURCE_DIR
                                          "/tests/tools/strata/hall_with_doors.yaml --per-day "
                                          "--seed 4 --quiet --force --out " +
                                          in_quotes(days->path()));
    ASSERT_EQ(made.code, 0) << made.out;
  }
  static void TearDownTestSuite() { delete days; }

  void SetUp() override {
    const Outcome learned = learn(day(1) + " --out " + maps());
    ASSERT_EQ(learned.code, 0) << learned.out;
  }
  static std::string day(int number) {
    return in_quotes(days->path() / ("day_" + std::to_string(number)) / "log.clf");
  }
  [[nodiscard]] std::string maps() const { return in_quotes(folder.path() / "maps"); }
  static Outcome learn(const std::string& arguments) {
    return test::run_strata("learn " + arguments + " 2>&1");
  }
  [[nodiscard]] memory::StoreSummary store() const {
    return memory::summarize_store(folder.path() / "maps" / "strata.db");
  }

  static inline test::TemporaryDirectory* days = nullptr;
  const test::TemporaryDirectory folder;
};

TEST_F(LearnUpdate, DoesNotTakeTheMemoryAwayInSilence) {
  const std::string again = day(2) + " --update " + maps() + " --out " + maps();
  for (const char* only : {"em", "em,patch", "timescale"}) {
    const Outcome refused = learn(again + " --only " + only);
    EXPECT_NE(refused.code, 0) << only;
    EXPECT_THAT(refused.out, HasSubstr("would take away")) << only;
    EXPECT_EQ(store().runs.size(), 1U);
    EXPECT_EQ(store().timescales.size(), 1U);
    EXPECT_EQ(store().patch_maps.size(), 1U);
  }
  EXPECT_EQ(learn(again + " --only em --force").code, 0);
  EXPECT_TRUE(store().timescales.empty());
}

TEST_F(LearnUpdate, LeavesOutALogThatWasLearnedAlready) {
  const auto observations = store().timescales.front().observations;
  const Outcome same = learn(day(1) + " --update " + maps() + " --out " + maps());
  EXPECT_EQ(same.code, 0) << same.out;
  EXPECT_THAT(same.out, HasSubstr("is what run 0 was learned from"));
  EXPECT_THAT(same.out, HasSubstr("stays as it is"));
  EXPECT_EQ(store().runs.size(), 1U);
  EXPECT_EQ(store().timescales.front().observations, observations);

  const Outcome both =
      learn(day(1) + " " + day(2) + " " + day(2) + " --update " + maps() + " --out " + maps());
  EXPECT_EQ(both.code, 0) << both.out;
  EXPECT_THAT(both.out, HasSubstr("is what run 0 was learned from"));
  EXPECT_THAT(both.out, HasSubstr("is what run 2 was learned from"));
  EXPECT_EQ(store().runs.size(), 2U);

  const Outcome forced = learn(day(2) + " --update " + maps() + " --out " + maps() + " --force");
  EXPECT_EQ(forced.code, 0) << forced.out;
  EXPECT_EQ(store().runs.size(), 2U) << "nightly recipes replace what is there by --force";

  const Outcome again = learn(day(2) + " --update " + maps() + " --out " + maps() + " --again");
  EXPECT_EQ(again.code, 0) << again.out;
  EXPECT_EQ(store().runs.size(), 3U);
}

TEST_F(LearnUpdate, SaysWhichLogHasNoPlaceAndFailsWhereNoneHas) {
  const test::TemporaryDirectory other;
  const Outcome made =
      test::run_strata("simulate " STRATA_SOURCE_DIR
                       "/tools/simulate/scenarios/corridor_box.yaml --per-day --seed 4 --quiet "
                       "--force --out " +
                       in_quotes(other.path()));
  ASSERT_EQ(made.code, 0) << made.out;
  const std::string room = in_quotes(other.path() / "day_1" / "log.clf");
  const Outcome refused = learn(room + " --update " + maps() + " --out " + maps());
  EXPECT_NE(refused.code, 0) << refused.out;
  EXPECT_THAT(refused.out, HasSubstr("nothing was learned"));
  EXPECT_EQ(store().runs.size(), 1U);

  const Outcome some = learn(room + " " + day(2) + " --update " + maps() + " --out " + maps());
  EXPECT_EQ(some.code, 0) << some.out;
  EXPECT_EQ(store().runs.size(), 2U);
  EXPECT_THAT(some.out, HasSubstr("day_1/log.clf was left out"));
}

}  // namespace
}  // namespace strata::tools
